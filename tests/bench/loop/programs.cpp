#include "programs.hpp"

#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>

#include "base/error.hpp"
#include "runtime/log.hpp"
#include "runtime/paths.hpp"
#include "support/own_domain.hpp"

namespace baton::bench {
namespace fs = std::filesystem;

Programs::Programs() : domain_(test::ownDomain()) {
  std::string pattern = (fs::temp_directory_path() / "baton-bench-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw UnavailableError("cannot make a folder like " + pattern);
  folder_ = pattern;
  setenv("BATON_HOME", folder_.c_str(), 1);
  signals_.async_wait([this](const boost::system::error_code& error, int) { is_interrupted_ = !error; });
}

Programs::~Programs() {
  for (const auto& child : children_) child->signal(SIGTERM);
  for (int waited_s = 0; anyRunning() && waited_s < 30; ++waited_s) serveFor(std::chrono::seconds(1));
  children_.clear();
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void Programs::start(const std::string& program, std::vector<std::string> arguments, int spared_exit_code) {
  const fs::path log = folder_ / (std::to_string(children_.size()) + ".log");
  children_.push_back(std::make_unique<Child>(
      executor_,
      Child::Command{
          .name = program, .program = siblingProgram(program), .arguments = std::move(arguments), .log_file = log},
      [this, log, spared_exit_code](Child& child, const Child::End& end) {
        if (end.by_signal || (end.value != 0 && end.value != spared_exit_code)) {
          problem_ = child.name() + " ended with " + end.text() + "; its last words:\n" + lastLines(log, 20);
        }
      }));
}

bool Programs::anyRunning(const std::string& program) const {
  return std::any_of(children_.begin(), children_.end(), [&](const auto& child) {
    return child->isRunning() && (program.empty() || child->name() == program);
  });
}

void Programs::serveFor(std::chrono::milliseconds time) {
  const auto until = std::chrono::steady_clock::now() + time;
  executor_.restart();
  while (anyRunning() && executor_.run_one_until(until) > 0) continue;
}

void Programs::waitUntil(const std::function<bool()>& condition) {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(5);
  while (!condition()) {
    serveFor(std::chrono::milliseconds(20));
    if (is_interrupted_) throw Error(ExitCode::kInterrupted, "interrupted");
    if (!problem_.empty()) throw UnavailableError(problem_);
    if (std::chrono::steady_clock::now() > give_up) throw UnavailableError("nothing happens any more");
  }
}

std::vector<std::string> Programs::finish() {
  waitUntil([this] { return !anyRunning(); });
  std::vector<std::string> printed;
  for (const auto& child : children_) {
    printed.push_back(readFile(child->command().log_file));
    fs::remove(child->command().log_file);
  }
  children_.clear();
  fs::remove_all(folder_ / "runs");  // recordings would fill the disk
  return printed;
}

nlohmann::json Programs::run(const std::string& program, std::vector<std::string> arguments) {
  start(program, std::move(arguments));
  return jsonIn(finish().front());
}

std::string Programs::write(const std::string& name, const std::string& text) const {
  const fs::path file = folder_ / name;
  std::ofstream(file, std::ios::binary) << text;
  return file.string();
}

nlohmann::json jsonIn(const std::string& text) {
  const std::size_t start = text.starts_with('{') ? 0 : text.find("\n{");
  try {
    return nlohmann::json::parse(start == std::string::npos ? "" : text.substr(start));
  } catch (const nlohmann::json::exception&) {
    throw UnavailableError("expected JSON, found:\n" + text);
  }
}

}  // namespace baton::bench
