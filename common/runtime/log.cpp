#include "runtime/log.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "dds/participant.hpp"

namespace baton {

void setUpLog(const std::string& name) {
  spdlog::set_default_logger(spdlog::stderr_logger_mt(name));
  spdlog::set_pattern("%H:%M:%S.%f %l %n: %v");
  spdlog::flush_on(spdlog::level::info);
  dds::redirectDdsLog([](int level, const std::string& text) {
    spdlog::log(level == 0 ? spdlog::level::err : spdlog::level::warn, "dds: {}", text);
  });
}

}  // namespace baton
