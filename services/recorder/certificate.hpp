/// The certificate of a recording: what its files hold, of each writer, held against what came and what was sent; what
/// was left out on purpose; and what is missing.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "stream.hpp"

namespace baton {

/// What the files hold of a stream.
struct RecordedStream {
  std::uint64_t first_sequence = 0;
  std::uint64_t last_sequence = 0;
  std::uint64_t count = 0;
  std::uint64_t missing = 0;    // lost between first and last
  std::uint64_t hash = 0;       // of the payloads in order, from `hash_seed` on
  std::uint64_t hash_seed = 0;  // 0 unless the first parts have been dropped
};

/// Steps that are not in the files, on purpose.
struct Hole {
  std::uint32_t take = 0;
  std::uint64_t from_step = 0;
  std::uint64_t to_step = 0;
  std::uint64_t samples = 0;  // of all topics
  std::string reason{};
};

/// The holes of a recording as they come to be.
class Holes {
 public:
  void open(std::uint32_t take, std::uint64_t from_step, const std::string& reason);
  /// A sample that is not written; while one is open.
  void leaveOut() { ++list_.back().samples; }
  void close(std::uint64_t to_step);
  void clear();
  [[nodiscard]] bool isOpen() const { return is_open_; }
  /// Of these steps; one that is still open ends with them.
  [[nodiscard]] std::vector<Hole> between(std::uint64_t from_step, std::uint64_t to_step) const;

 private:
  std::vector<Hole> list_;
  bool is_open_ = false;
};

/// Why a recording ends where it does.
struct Ending {
  bool run_is_over = true;  // and everybody has said what was sent
  bool is_wanted = true;    // else what comes after is missing
  std::string reason{};     // empty: the run is over
};

class Certificate {
 public:
  Certificate(const Ledger& ledger, Ending ending);

  void add(const Stream& stream, RecordedStream recorded);
  void setHoles(std::vector<Hole> holes) { holes_ = std::move(holes); }
  /// File names, in order, and the index of the first one.
  void setParts(std::vector<std::string> parts, unsigned first) {
    parts_ = std::move(parts);
    first_part_ = first;
  }
  void setSteps(std::uint64_t from_step, std::uint64_t to_step);
  /// Patterns of the scenario's choice of topics that no topic matched.
  void setUnmatched(std::vector<std::string> patterns) { unmatched_ = std::move(patterns); }
  /// What is the matter beyond what the ledger knows.
  void addProblem(const std::string& problem) { problems_.push_back(problem); }

  [[nodiscard]] const std::vector<std::string>& problems() const { return problems_; }
  [[nodiscard]] bool isComplete() const { return problems_.empty(); }
  /// The verdict in a sentence that begins with "complete" or "incomplete".
  [[nodiscard]] std::string summary() const;
  /// All of it, as JSON.
  [[nodiscard]] std::string text() const;

 private:
  const Ledger& ledger_;
  Ending ending_;
  std::vector<std::string> problems_;
  nlohmann::ordered_json rows_ = nlohmann::ordered_json::array();
  std::vector<Hole> holes_;
  std::vector<std::string> unmatched_;
  std::vector<std::string> parts_;
  unsigned first_part_ = 0;
  std::uint64_t from_step_ = 0;
  std::uint64_t to_step_ = 0;
};

}  // namespace baton
