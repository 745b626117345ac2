#include "bench.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iterator>

#include "base/error.hpp"

namespace baton::bench {
namespace {

/// Says what is being measured and how long the rest will take, judging by how long each case took last time.
class Progress {
 public:
  void begin(int round, const Plan& plan, std::size_t index, const std::vector<Case>& order) {
    double left_s = 0.0;
    for (std::size_t i = index; i < order.size(); ++i) left_s += durationOf(order[i]);
    for (const Case& one : order) left_s += (plan.rounds - round - 1) * durationOf(one);
    if (is_terminal_) std::fputs("\r\033[K", stderr);
    std::fprintf(stderr, "round %d of %d, %zu of %zu: %s, %.0f s left%s", round + 1, plan.rounds, index + 1,
                 order.size(), order[index].name.c_str(), left_s, is_terminal_ ? "" : "\n");
    began_ = std::chrono::steady_clock::now();
  }
  void end(const Case& one) {
    durations_s_[one.name] = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    if (is_terminal_) std::fputs("\r\033[K", stderr);
  }

 private:
  [[nodiscard]] double durationOf(const Case& one) const {
    const auto known = durations_s_.find(one.name);
    if (known != durations_s_.end()) return known->second;
    return one.kind == Case::Kind::kRaw ? 1.5 : 1.5 + 0.5 * one.processes();
  }
  bool is_terminal_ = isatty(STDERR_FILENO) != 0;
  std::map<std::string, double> durations_s_;
  std::chrono::steady_clock::time_point began_;
};

}  // namespace

std::vector<Case> casesCalled(const std::vector<std::string>& words) {
  if (words.empty()) return allCases();
  const auto isName = [](const std::string& word) {
    return std::any_of(allCases().begin(), allCases().end(), [&](const Case& one) { return one.name == word; });
  };
  const auto fits = [&](const Case& one, const std::string& word) {
    return isName(word) ? one.name == word : one.name.find(word) != std::string::npos;
  };
  std::string names;
  for (const Case& one : allCases()) names += " " + one.name;
  for (const std::string& word : words) {
    const bool is_known =
        std::any_of(allCases().begin(), allCases().end(), [&](const Case& one) { return fits(one, word); });
    if (!is_known) throw UsageError("--only " + word + ": expected a part of one of" + names);
  }
  std::vector<Case> chosen;
  std::copy_if(allCases().begin(), allCases().end(), std::back_inserter(chosen), [&](const Case& one) {
    return std::any_of(words.begin(), words.end(), [&](const std::string& word) { return fits(one, word); });
  });
  return chosen;
}

Results measureAll(const Plan& plan, Programs& programs) {
  const bool has_in_process = canRunInProcess(programs);
  std::vector<Case> order;
  std::copy_if(plan.cases.begin(), plan.cases.end(), std::back_inserter(order),
               [&](const Case& one) { return one.kind != Case::Kind::kInProcess || has_in_process; });
  Results results;
  Progress progress;
  for (int round = 0; round < plan.rounds; ++round) {
    for (std::size_t i = 0; i < order.size(); ++i) {
      progress.begin(round, plan, i, order);
      results[order[i].name].push_back(measure(order[i], plan.steps, programs));
      progress.end(order[i]);
    }
    // Back and forth: a machine that gets slower or faster favours nobody.
    std::reverse(order.begin(), order.end());
  }
  return results;
}

}  // namespace baton::bench
