/// Checked POSIX files: what a recording is written to and read from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "mcap/bytes.hpp"

namespace baton::mcap {

/// An open file descriptor, closed at the end of its life.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() { reset(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int get() const { return fd_; }
  /// Closes now; 0 or errno.
  int reset();

 private:
  int fd_;
};

/// A file written from its start to its end. Interrupted calls are resumed; anything else that goes wrong is a
/// WriteError, and from then on every call but the destructor throws that same error: after a failed write or sync
/// nobody can know what the file holds, so nothing more is put into it.
class OutputFile {
 public:
  /// kReplace: the bytes go to PATH.part, which takes the place of PATH when it is closed, and not before; a link,
  /// or a device such as /dev/null, is written to as it is.
  enum class IfExists { kRefuse, kReplace };

  /// Creates the file. Throws UnavailableError when it, or for kReplace PATH.part, is there already, or when it cannot
  /// be created.
  OutputFile(std::filesystem::path path, IfExists if_exists);
  /// Without close(), what was written stays as it is; PATH.part is taken away.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Hands all bytes to the operating system.
  void write(ByteView bytes);
  /// Waits until all bytes, and the file's name in its folder, are on the storage device.
  void sync();
  /// Closes and reports what the system held back until then.
  void close();
  /// Takes the file away, unless it was there before; nothing can be done with it any more.
  void discard() noexcept;
  /// Takes away all files of this process that were made and are neither closed nor gone. Safe in a signal handler.
  static void removeUnfinished() noexcept;
  /// Throws the error of an earlier failure again, or WriteError when the file is closed.
  void requireHealthy() const;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Bytes the operating system has taken.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Bytes known to be on the storage device.
  [[nodiscard]] std::uint64_t durableSize() const { return durable_size_; }

 private:
  [[nodiscard]] bool isDraft() const { return !present_path_.empty() && present_path_ != path_; }
  [[noreturn]] void fail(const std::string& what, int error);
  [[nodiscard]] int create() const;
  void setFinished() const noexcept;

  std::filesystem::path path_;
  std::filesystem::path present_path_;  // empty once it is closed or gone
  bool is_own_;                         // made here, not a device that was there
  Descriptor fd_;
  std::uint64_t size_ = 0;
  std::uint64_t durable_size_ = 0;
  bool is_name_durable_ = false;
  std::string failure_;  // empty while all is well
};

/// A regular file read at any place. Read through system calls, not memory-mapped: an input error or a file cut by
/// somebody else is then an exception, not a signal.
class InputFile {
 public:
  /// Throws UnavailableError when it cannot be opened, UsageError when it is not a regular file.
  explicit InputFile(std::filesystem::path path);

  /// Fills `out` from `offset` on. Throws FormatError when the file ends before, UnavailableError when it cannot be
  /// read.
  void read(std::uint64_t offset, std::span<std::byte> out) const;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Size when it was opened. A file that is still being recorded is read up to there.
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  std::filesystem::path path_;
  Descriptor fd_;
  std::uint64_t size_ = 0;
};

}  // namespace baton::mcap
