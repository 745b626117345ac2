#include "mcap/file.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <mutex>
#include <system_error>
#include <utility>
#include <vector>

namespace baton::mcap {
namespace {

std::string errorText(int error) { return std::generic_category().message(error); }

/// Calls again while a signal interrupts.
template <class Call>
auto resumed(Call call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

/// Signals of this thread wait while it lives.
class SignalPause {
 public:
  SignalPause() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before_);
  }
  ~SignalPause() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalPause(const SignalPause&) = delete;
  SignalPause& operator=(const SignalPause&) = delete;

 private:
  sigset_t before_{};
};

/// Changed while signals wait: a handler never finds it half changed, nor without a file that is there already.
constinit std::vector<const OutputFile*> g_unfinished;
constinit std::mutex g_unfinished_mutex;

std::filesystem::path presentPath(std::filesystem::path path, OutputFile::IfExists if_exists) {
  std::error_code none;
  const std::filesystem::file_type type = std::filesystem::symlink_status(path, none).type();
  const bool is_file = type == std::filesystem::file_type::regular || type == std::filesystem::file_type::not_found;
  if (if_exists == OutputFile::IfExists::kReplace && is_file) path += ".part";
  return path;
}

int openOutput(const std::filesystem::path& path, bool is_own, bool is_draft) {
  const int existing = is_own ? O_EXCL : O_TRUNC;
  const int fd = resumed([&] { return ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | existing, 0644); });
  if (fd >= 0) return fd;
  const int error = errno;
  if (error == EEXIST) {
    throw UnavailableError(path.string() + " is there already and is not overwritten: " +
                           (is_draft ? "it is being written, or a command that was killed has left it; remove it then"
                                     : "choose another name or remove it"));
  }
  throw UnavailableError("cannot create " + path.string() + ": " + errorText(error));
}

int openInput(const std::filesystem::path& path) {
  // Not blocking: opening a pipe without a writer would hang before it can be refused.
  const int fd = resumed([&] { return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK); });
  if (fd < 0) throw UnavailableError("cannot open " + path.string() + ": " + errorText(errno));
  return fd;
}

/// 0 or errno. A file system that cannot sync a folder does not need it.
int syncFolderOf(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const Descriptor fd(resumed([&] { return ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); }));
  if (fd.get() < 0) return errno;
  if (resumed([&] { return ::fsync(fd.get()); }) == 0 || errno == EINVAL || errno == ENOTSUP) return 0;
  return errno;
}

}  // namespace

int Descriptor::reset() {
  const int fd = std::exchange(fd_, -1);
  // Linux releases the descriptor even when close is interrupted: calling again could close somebody else's.
  return fd < 0 || ::close(fd) == 0 || errno == EINTR ? 0 : errno;
}

OutputFile::OutputFile(std::filesystem::path path, IfExists if_exists)
    : path_(std::move(path)),
      present_path_(presentPath(path_, if_exists)),
      is_own_(if_exists == IfExists::kRefuse || present_path_ != path_),
      fd_(create()) {}

OutputFile::~OutputFile() {
  if (isDraft()) discard();
  setFinished();
}

int OutputFile::create() const {
  const SignalPause pause;
  const int fd = openOutput(present_path_, is_own_, isDraft());
  const std::lock_guard lock(g_unfinished_mutex);
  if (is_own_) g_unfinished.push_back(this);
  return fd;
}

void OutputFile::setFinished() const noexcept {
  const SignalPause pause;
  const std::lock_guard lock(g_unfinished_mutex);
  std::erase(g_unfinished, this);
}

void OutputFile::removeUnfinished() noexcept {
  for (const OutputFile* file : g_unfinished) ::unlink(file->present_path_.c_str());
}

void OutputFile::discard() noexcept {
  fd_.reset();
  if (is_own_ && !present_path_.empty()) ::unlink(present_path_.c_str());
  setFinished();
  present_path_.clear();
}

void OutputFile::fail(const std::string& what, int error) {
  failure_ = path_.string() + ": " + what + ": " + errorText(error);
  throw WriteError(failure_);
}

void OutputFile::requireHealthy() const {
  if (!failure_.empty()) throw WriteError(failure_);
  if (fd_.get() < 0) throw WriteError(path_.string() + " is closed");
}

void OutputFile::write(ByteView bytes) {
  requireHealthy();
  const std::uint64_t begin = size_;
  ByteView rest = bytes;
  while (!rest.empty()) {
    const ssize_t taken = resumed([&] { return ::write(fd_.get(), rest.data(), rest.size()); });
    if (taken <= 0) {
      // A regular file that takes nothing and gives no reason has no room.
      const int error = taken < 0 ? errno : ENOSPC;
      fail("wrote " + std::to_string(size_ - begin) + " of " + std::to_string(bytes.size()) + " bytes at byte " +
               std::to_string(begin),
           error);
    }
    size_ += static_cast<std::uint64_t>(taken);
    rest = rest.subspan(static_cast<std::size_t>(taken));
  }
}

void OutputFile::sync() {
  requireHealthy();
  const std::string what = "only " + std::to_string(durable_size_) + " of " + std::to_string(size_) +
                           " bytes are known to be on the storage device";
  if (resumed([&] { return ::fdatasync(fd_.get()); }) != 0) fail(what, errno);
  if (!is_name_durable_) {
    if (const int error = syncFolderOf(path_)) fail(what, error);
    is_name_durable_ = true;
  }
  durable_size_ = size_;
}

void OutputFile::close() {
  if (!failure_.empty()) {
    fd_.reset();
    throw WriteError(failure_);
  }
  if (const int error = fd_.reset()) fail("closing after " + std::to_string(size_) + " bytes", error);
  const bool was_draft = isDraft();
  if (was_draft && ::rename(present_path_.c_str(), path_.c_str()) != 0) {
    fail("it is written and cannot take its place", errno);
  }
  setFinished();
  present_path_.clear();
  if (!was_draft || !is_name_durable_) return;
  if (const int error = syncFolderOf(path_)) fail("its name is not known to be on the storage device", error);
}

InputFile::InputFile(std::filesystem::path path) : path_(std::move(path)), fd_(openInput(path_)) {
  struct stat status {};
  if (::fstat(fd_.get(), &status) != 0) {
    throw UnavailableError("cannot inspect " + path_.string() + ": " + errorText(errno));
  }
  if (S_ISDIR(status.st_mode)) {
    throw UsageError(path_.string() +
                     " is a folder, as rosbag2 makes for a recording: give the .mcap file in it; of a " +
                     ".db3 file `ros2 bag convert` makes one, `mcap convert` also of a .bag file");
  }
  if (!S_ISREG(status.st_mode)) throw UsageError(path_.string() + " is not a regular file");
  size_ = static_cast<std::uint64_t>(status.st_size);
}

void InputFile::read(std::uint64_t offset, std::span<std::byte> out) const {
  while (!out.empty()) {
    const ssize_t got = resumed([&] { return ::pread(fd_.get(), out.data(), out.size(), static_cast<off_t>(offset)); });
    if (got < 0) {
      throw UnavailableError("cannot read " + path_.string() + " at byte " + std::to_string(offset) + ": " +
                             errorText(errno));
    }
    if (got == 0) {
      throw FormatError(path_.string() + " ends at byte " + std::to_string(offset) + ", " + std::to_string(out.size()) +
                        " more bytes were expected");
    }
    offset += static_cast<std::uint64_t>(got);
    out = out.subspan(static_cast<std::size_t>(got));
  }
}

}  // namespace baton::mcap
