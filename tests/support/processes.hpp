/// Programs under test, run as a person runs them, each test in a folder and a DDS domain of its own.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/checkout.hpp"

namespace baton::test {

struct Finished {
  int exit_code = -1;  // 128 + signal when one ended it
  std::string out;
  std::string err;
};

/// A folder that is deleted with everything in it, serving as BATON_HOME of what is started here.
class Bench {
 public:
  Bench();
  ~Bench();
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  [[nodiscard]] std::filesystem::path folder() const { return folder_; }
  /// That of this process alone.
  [[nodiscard]] int domain() const { return domain_; }
  /// Runs the `baton` command line to its end; --domain is added for commands that take one.
  [[nodiscard]] Finished baton(std::vector<std::string> arguments) const;
  /// The same, parsed from standard output.
  [[nodiscard]] nlohmann::json batonJson(std::vector<std::string> arguments) const;
  /// Starts a program and returns its process id; its output goes to `log` in the folder. Ended with the bench.
  [[nodiscard]] int start(const std::string& program, const std::vector<std::string>& arguments,
                          const std::string& log);
  /// Waits for a started program. Returns its exit code, 128 + signal when one ended it. Throws when it does not end.
  [[nodiscard]] int wait(int pid);
  /// Writes a file into the folder and returns its path.
  [[nodiscard]] std::string write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path folder_;
  int domain_;
  std::map<int, std::filesystem::path> started_;  // process id and log
};

/// Where the programs are.
[[nodiscard]] std::filesystem::path programFolder();

/// A script takes the place of a program in the folder "programs" of the bench.
void standIn(const Bench& bench, const std::string& program, const std::string& script);
/// A copy of all programs of a run, but that one of them is this script. Returns its folder, which lies in the bench's.
[[nodiscard]] std::filesystem::path programsBut(const Bench& bench, const std::string& program,
                                                const std::string& script);

/// Runs a program to its end.
[[nodiscard]] Finished runProgram(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                                  const std::filesystem::path& home);

/// Waits until `condition` holds, by looking at it again and again; false when it does not within the minutes, which
/// fails a test that is broken and decides nothing about one that is not.
[[nodiscard]] bool eventually(const std::function<bool()>& condition,
                              std::chrono::minutes patience = std::chrono::minutes(4));

/// Processes whose command line contains `text`.
[[nodiscard]] std::vector<int> processesWith(const std::string& text);

}  // namespace baton::test
