/// What the cases share: a folder, a stopwatch, and a program that is run and watched.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "rows.hpp"

namespace baton::bench {

struct Plan {
  std::uint64_t megabytes = 1000;         // of the file that is read
  std::uint64_t written_megabytes = 200;  // of payload in one run of the writer
  int rounds = 3;
  std::filesystem::path ram = "/dev/shm";
  std::filesystem::path disk;
};

using Report = std::function<void(const Row&)>;

/// Every case of the writer, and of what reads: each row as soon as it is known.
void measureWriter(const Plan& plan, const Report& report);
void measureReader(const Plan& plan, const Report& report);

/// A folder in `parent` that goes with this object.
class Scratch {
 public:
  explicit Scratch(const std::filesystem::path& parent);
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// A program that stands beside this one, run to its end with its output thrown away.
struct Ended {
  int exit_code = 0;
  double seconds = 0.0;
  double peak_MB = 0.0;  // of memory
};
[[nodiscard]] Ended runProgram(const std::string& name, const std::vector<std::string>& arguments);
/// The memory that this process has at present [MB].
[[nodiscard]] double residentMegabytes();

}  // namespace baton::bench
