#include "recorder.hpp"

#include <spdlog/spdlog.h>

#include "run_reading.hpp"

namespace baton {
namespace {

constexpr std::size_t kQueueBytes = std::size_t{256} << 20;
constexpr std::size_t kWakeSamples = 1024;

}  // namespace

Recorder::Recorder(Service& service)
    : service_(service),
      queue_(kQueueBytes, kWakeSamples, service.participant().clock()),
      topics_(service.participant(), service.executor(), rulesOfRun(service),
              [this](std::uint32_t topic, bool is_foreign, const dds::RawSample& sample) {
                (void)queue_.push(topic, sample, is_foreign ? SampleQueue::Share::kHalf : SampleQueue::Share::kWhole);
              }),
      session_(service, queue_, topics_) {
  service.answersNoSteps();
  service.onEnd([this] { session_.runHasEnded(); });
  service.input(dds::topics::kRecordRequest, {},
                [this](const msg::RecordRequest& request, const dds::RawSample& sample) {
                  if (!service_.isFromBefore(sample)) session_.ask(request);
                });
  requireRecorded(service, topics_);
  topics_.watch();
  thread_ = std::thread([this] {
    try {
      result_ = session_.run();
    } catch (const std::exception& error) {
      spdlog::error("the recorder fails: {}", error.what());
    }
    service_.stop(result_);
  });
}

Recorder::~Recorder() {
  queue_.close();
  if (thread_.joinable()) thread_.join();
}

ExitCode Recorder::run() {
  service_.run();
  queue_.close();
  thread_.join();
  return result_;
}

}  // namespace baton
