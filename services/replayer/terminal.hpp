/// Keys of the terminal that the replay was started on: read as they are struck, without echo, while this lives.
#pragma once

#include <string>
#include <vector>

namespace baton {

enum class Key { kSpace, kRight, kLeft, kPlus, kMinus, kQuit };

/// What keys a terminal's bytes mean. Others are passed over; a sequence that is cut stays in `bytes` for the next
/// time.
[[nodiscard]] std::vector<Key> takeKeys(std::string& bytes);

class Terminal {
 public:
  /// Takes standard input when it is a terminal and this process is in its foreground.
  Terminal();
  /// Puts the terminal back as it was.
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  [[nodiscard]] bool hasKeys() const;
  /// To be waited for; -1 without keys.
  [[nodiscard]] int descriptor() const;
  /// The keys struck so far; does not wait.
  [[nodiscard]] std::vector<Key> keys();

 private:
  std::string bytes_;
};

/// Puts the terminal back as it was, if it was taken; may be called by a signal handler.
void restoreTerminal() noexcept;

}  // namespace baton
