#include "runtime/log.hpp"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <cerrno>
#include <cstring>
#include <deque>
#include <fstream>
#include <memory>
#include <mutex>
#include <sstream>
#include <utility>

#include "base/text.hpp"
#include "dds/participant.hpp"
#include "runtime/say.hpp"

namespace baton {
namespace {

class Sink final : public spdlog::sinks::base_sink<std::mutex> {
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    // One line each: what others are called could hold a line break, and look like another message.
    const std::string text = escaped(std::string_view(message.payload.data(), message.payload.size()));
    spdlog::details::log_msg shown = message;
    shown.payload = text;
    formatter_->format(shown, line);
    sayText(std::string_view(line.data(), line.size()), stderr);
  }
  void flush_() override { std::fflush(stderr); }
};

}  // namespace

void setUpLog(const std::string& name) {
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(name, std::make_shared<Sink>()));
  spdlog::set_pattern("%H:%M:%S.%f %l %n: %v");
  spdlog::flush_on(spdlog::level::info);
  dds::redirectDdsLog([](int level, const std::string& text) {
    spdlog::log(level == 0 ? spdlog::level::err : spdlog::level::warn, "dds: {}", text);
  });
}

void logLastLines(const std::filesystem::path& log, std::size_t count) {
  std::istringstream lines(lastLines(log, count));
  for (std::string line; std::getline(lines, line);) spdlog::error("{}", line);
}

std::string lastLines(const std::filesystem::path& log, std::size_t count) {
  std::ifstream stream(log);
  if (!stream) return "  cannot be read: " + std::string(std::strerror(errno)) + "\n";
  std::deque<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(std::move(line));
    if (lines.size() > count) lines.pop_front();
  }
  std::string text;
  // The DDS library writes names of others as they are.
  for (const std::string& line : lines) text += "  " + escaped(line) + "\n";
  return text;
}

std::string lastError(const std::filesystem::path& log) {
  std::ifstream stream(log);
  std::string last;
  std::string error;
  for (std::string line; std::getline(stream, line);) {
    if (line.find(" error ") != std::string::npos || line.starts_with("baton-")) error = line;
    last = line;
  }
  return escaped(error.empty() ? last : error);
}

}  // namespace baton
