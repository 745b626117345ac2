/// A service's writer on a topic of the loop: a Writer, and the faults that the scenario wants on it.
#pragma once

#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "messages/values.hpp"
#include "runtime/service.hpp"
#include "time/fault.hpp"

namespace baton {

template <class T>
class LoopOutput {
 public:
  /// As Service::output().
  LoopOutput(Service& service, const dds::Topic<T>& topic, const std::vector<std::string>& readers)
      : service_(service), writer_(service.output(topic, readers)) {
    for (const Fault& fault : service.scenario().faults) {
      if (fault.service == service.options().name && fault.topic == topic.name) faults_.push_back({fault, {}, false});
    }
  }

  /// As Writer::write(), which it is where no fault is wanted.
  void write(const T& message) {
    if (faults_.empty()) {
      writer_.write(message);
    } else {
      writeFaulty(message);
    }
  }
  [[nodiscard]] std::span<const std::byte> payload() const { return writer_.payload(); }

 private:
  struct Wanted {
    Fault fault;
    std::vector<double> before;  // the numbers of the last step that was spared
    bool is_told = false;
  };

  void writeFaulty(T message);
  void corrupt(Wanted& wanted, std::span<double> values) const;
  void writeLater(const T& message, double delay_s);
  void tell(Wanted& wanted);

  Service& service_;
  dds::Writer<T>& writer_;
  std::vector<Wanted> faults_;
};

template <class T>
void LoopOutput<T>::corrupt(Wanted& wanted, std::span<double> values) const {
  for (std::size_t i = 0; i < values.size(); ++i) {
    switch (wanted.fault.kind) {
      case FaultKind::kNan: values[i] = std::numeric_limits<double>::quiet_NaN(); break;
      case FaultKind::kStuck:
        if (i < wanted.before.size()) values[i] = wanted.before[i];
        break;
      case FaultKind::kBias: values[i] += wanted.fault.by[std::min(i, wanted.fault.by.size() - 1)]; break;
      default: break;
    }
  }
}

template <class T>
void LoopOutput<T>::writeFaulty(T message) {
  int copies = 1;
  double delay_s = 0.0;
  for (Wanted& wanted : faults_) {
    const std::span<double> values = valuesOf(message);
    if (!strikes(wanted.fault, message.step())) {
      wanted.before.assign(values.begin(), values.end());
      continue;
    }
    tell(wanted);
    switch (wanted.fault.kind) {
      case FaultKind::kDrop: copies = 0; break;
      case FaultKind::kDuplicate: copies = 2; break;
      case FaultKind::kDelay: delay_s = std::max(delay_s, wanted.fault.seconds); break;
      default: corrupt(wanted, values);
    }
  }
  for (; copies > 0; --copies) {
    if (delay_s > 0.0) {
      writeLater(message, delay_s);
    } else {
      writer_.write(message);
    }
  }
}

template <class T>
void LoopOutput<T>::writeLater(const T& message, double delay_s) {
  const auto timer = std::make_shared<boost::asio::steady_timer>(service_.executor());
  boost::asio::post(service_.executor(), [this, timer, message, delay_s] {
    timer->expires_after(std::chrono::nanoseconds(static_cast<std::int64_t>(delay_s * 1e9)));
    timer->async_wait([this, timer, message](const boost::system::error_code& error) {
      const std::lock_guard lock(service_.mutex());
      if (!error && !service_.isOver()) writer_.write(message);
    });
  });
}

template <class T>
void LoopOutput<T>::tell(Wanted& wanted) {
  if (std::exchange(wanted.is_told, true)) return;
  service_.event(msg::SEVERITY_WARNING, "fault",
                 std::string("as the scenario wants: ") + toString(wanted.fault.kind) + " on " + writer_.topic());
}

}  // namespace baton
