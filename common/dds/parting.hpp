/// The end of what uses DDS. A forged datagram can keep a thread of Fast DDS busy for ever, with locks that every
/// reader and the participant need for their own end (common/README.md, "Forged RTPS"): a plain destructor would hang.
#pragma once

#include <chrono>
#include <future>
#include <memory>
#include <system_error>
#include <thread>
#include <utility>

namespace baton::dds {

/// How long the end of a participant and its endpoints may take. It takes milliseconds.
inline constexpr std::chrono::seconds kPartingPatience{10};

/// Says on standard error that something which uses DDS could not be destroyed. leave() then runs no destructors.
void noteLeftover() noexcept;

/// Destroys `owner` and returns true. When that does not end in time, leaves it as it is with the thread that tries,
/// and returns false; the process must end by leave().
template <class Owner>
[[nodiscard]] bool partFrom(std::unique_ptr<Owner> owner, std::chrono::milliseconds patience = kPartingPatience) {
  const auto kept = std::make_shared<std::unique_ptr<Owner>>(std::move(owner));
  std::packaged_task<void()> end([kept] { kept->reset(); });
  const std::future<void> ended = end.get_future();
  std::thread thread;
  try {
    thread = std::thread(std::move(end));
  } catch (const std::system_error&) {  // no thread is to be had: without a limit, then
    kept->reset();
    return true;
  }
  if (ended.wait_for(patience) == std::future_status::ready) {
    thread.join();
    return true;
  }
  thread.detach();
  noteLeftover();
  return false;
}

/// Parts from what it holds, whichever way its scope is left.
template <class Owner>
class Parting {
 public:
  template <class... Arguments>
  explicit Parting(Arguments&&... arguments) : owner_(std::make_unique<Owner>(std::forward<Arguments>(arguments)...)) {}
  ~Parting() { (void)partFrom(std::move(owner_)); }
  Parting(const Parting&) = delete;
  Parting& operator=(const Parting&) = delete;

  [[nodiscard]] Owner& operator*() const { return *owner_; }
  [[nodiscard]] Owner* operator->() const { return owner_.get(); }

 private:
  std::unique_ptr<Owner> owner_;
};

/// What main() returns. Does not return when something could not be destroyed: the end of the program would wait for
/// it.
[[nodiscard]] int leave(int exit_code);

}  // namespace baton::dds
