/// Baton's programs, started for a measurement in a folder of their own and read when they have ended.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runtime/child.hpp"

namespace baton::bench {

class Programs {
 public:
  /// Makes the folder, which serves as BATON_HOME of all that is started and goes when this object does.
  Programs();
  /// Ends what still runs, in order.
  ~Programs();
  Programs(const Programs&) = delete;
  Programs& operator=(const Programs&) = delete;

  /// Starts a program that stands beside this one. Another exit code than 0 that is no problem may be named.
  void start(const std::string& program, std::vector<std::string> arguments, int spared_exit_code = 0);
  /// Waits until `condition`, which is looked at now and then. Throws UnavailableError when a program ends with an exit
  /// code that is a problem, or nothing comes of it in minutes, and Error when the user interrupts.
  void waitUntil(const std::function<bool()>& condition);
  /// Whether one of those that were started still runs; of this program alone, when one is named.
  [[nodiscard]] bool anyRunning(const std::string& program = "") const;
  /// Waits for all that were started. Returns what they printed, in the order of their start.
  [[nodiscard]] std::vector<std::string> finish();

  /// One program from start to end; the JSON it prints.
  [[nodiscard]] nlohmann::json run(const std::string& program, std::vector<std::string> arguments);

  /// Writes a file into the folder and returns its path.
  [[nodiscard]] std::string write(const std::string& name, const std::string& text) const;
  /// A DDS domain that no other test or benchmark uses.
  [[nodiscard]] int domain() const { return domain_; }

 private:
  void serveFor(std::chrono::milliseconds time);

  std::filesystem::path folder_;
  int domain_;
  boost::asio::io_context executor_{1};
  boost::asio::signal_set signals_{executor_, SIGINT, SIGTERM};
  bool is_interrupted_ = false;
  std::string problem_;
  std::vector<std::unique_ptr<Child>> children_;
};

/// The JSON in what a program printed, which may have warned before. Throws UnavailableError when there is none.
[[nodiscard]] nlohmann::json jsonIn(const std::string& text);

}  // namespace baton::bench
