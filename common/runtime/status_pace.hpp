/// When a timer writes a status: at once what has changed, seldom what has not. A run at rest should cost its machine
/// next to nothing.
#pragma once

namespace baton {

template <class Status>
class StatusPace {
 public:
  /// Ticks from one writing to the next when nothing changes: for readers that do not ask for the last sample.
  static constexpr int kTicks = 10;

  /// Asked at every tick with what would be written now.
  [[nodiscard]] bool isDue(const Status& now) { return !(now == last_) || ++unchanged_ >= kTicks; }
  void wrote(const Status& status) {
    last_ = status;
    unchanged_ = 0;
  }
  [[nodiscard]] const Status& last() const { return last_; }

 private:
  Status last_{};
  int unchanged_ = 0;
};

}  // namespace baton
