#include "certificate.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "base/plural.hpp"
#include "runtime/json.hpp"

namespace baton {

void Holes::open(std::uint32_t take, std::uint64_t from_step, const std::string& reason) {
  list_.push_back({.take = take, .from_step = from_step, .to_step = from_step, .reason = reason});
  is_open_ = true;
}

void Holes::close(std::uint64_t to_step) {
  if (!is_open_) return;
  list_.back().to_step = std::max(list_.back().from_step, to_step);
  is_open_ = false;
}

std::vector<Hole> Holes::between(std::uint64_t from_step, std::uint64_t to_step) const {
  std::vector<Hole> found = list_;
  if (is_open_) found.back().to_step = std::max(found.back().from_step, to_step);
  std::erase_if(found, [&](const Hole& hole) { return hole.samples == 0 || hole.to_step < from_step; });
  return found;
}

void Holes::clear() {
  list_.clear();
  is_open_ = false;
}

Certificate::Certificate(const Ledger& ledger, Ending ending)
    : ledger_(ledger),
      ending_(std::move(ending)),
      problems_(ending_.run_is_over ? ledger.problems() : ledger.problemsSoFar()) {
  if (!ending_.is_wanted) problems_.insert(problems_.begin(), ending_.reason);
}

void Certificate::setSteps(std::uint64_t from_step, std::uint64_t to_step) {
  from_step_ = from_step;
  to_step_ = to_step;
}

/// The row is about the files, so that whoever reads them can do the sums again; of what came, only what differs.
void Certificate::add(const Stream& stream, RecordedStream recorded) {
  const ReceivedStream& received = stream.received->second;
  if (received.count + received.missing == 0) return;
  if (recorded.count == 0) recorded = {};
  nlohmann::ordered_json row = ledger_.rowOf(*stream.received);
  row["first_sequence"] = recorded.first_sequence;
  row["last_sequence"] = recorded.last_sequence;
  row["count"] = recorded.count;
  row["missing"] = recorded.missing;
  row["stream_hash"] = std::to_string(recorded.hash);
  if (recorded.hash_seed != 0) row["hash_seed"] = std::to_string(recorded.hash_seed);
  if (recorded.count > 0) {
    // Left out on purpose between the first and the last.
    const std::uint64_t span = recorded.last_sequence - recorded.first_sequence + 1;
    if (const std::uint64_t left_out = span - recorded.count - recorded.missing; left_out > 0)
      row["left_out"] = left_out;
  }
  if (received.excused > 0) row["lost_before"] = received.excused;
  if (recorded.count != received.count || received.excused > 0) {
    row["received"] = received.count;
    row["received_hash"] = std::to_string(received.stream_hash);
  }
  rows_.push_back(std::move(row));
}

std::string Certificate::summary() const {
  std::string hint = unmatched_.empty() ? "" : fmt::format("; no topic matches {}", fmt::join(unmatched_, ", "));
  if (const std::vector<std::string> remarks = ledger_.remarks(); !remarks.empty()) {
    hint += "; not of the run: " + remarks.front();
    if (remarks.size() > 1) hint += fmt::format("; {} more remarks", remarks.size() - 1);
  }
  if (!isComplete()) return "incomplete: " + problems_.front() + hint;
  std::vector<std::string> but;
  for (const Hole& hole : holes_) {
    if (but.size() == 3) break;
    but.push_back(fmt::format("steps {} to {} ({})", hole.from_step, hole.to_step, hole.reason));
  }
  if (holes_.size() > but.size()) but.push_back(fmt::format("{} more", holes_.size() - but.size()));
  if (const std::size_t topics = ledger_.leftOut().size(); topics > 0) {
    but.push_back(counted(topics, "topic"));
  }
  std::string text = "complete";
  if (!ending_.reason.empty()) text += ", " + ending_.reason;
  if (!but.empty()) text += fmt::format(" but for what was left out on purpose: {}", fmt::join(but, ", "));
  return text + hint;
}

std::string Certificate::text() const {
  using Json = nlohmann::ordered_json;
  Json holes = Json::array(), gaps = Json::array();
  for (const Hole& hole : holes_) {
    holes.push_back({{"take", hole.take},
                     {"from_step", hole.from_step},
                     {"to_step", hole.to_step},
                     {"samples", hole.samples},
                     {"reason", hole.reason}});
  }
  for (const Ledger::Gap& gap : ledger_.gaps()) {
    const Ledger::Stream& stream = *ledger_.streams().find(gap.stream);
    if (stream.second.excused > 0) continue;  // all of them
    const Json row = ledger_.rowOf(stream);
    gaps.push_back({{"topic", gap.stream.first},
                    {"writer", dds::toString(gap.stream.second)},
                    {"service", row.value("service", "")},
                    {"first_sequence", gap.first_sequence},
                    {"last_sequence", gap.last_sequence},
                    {"reason", gap.reason}});
  }
  return toText(Json{{"complete", isComplete()},
                     {"problems", problems_},
                     {"remarks", ledger_.remarks()},
                     {"run_is_over", ending_.run_is_over},
                     {"ended", ending_.reason},
                     {"from_step", from_step_},
                     {"to_step", to_step_},
                     {"parts", parts_},
                     {"first_part", first_part_},
                     {"left_out", ledger_.leftOut()},
                     {"unmatched", unmatched_},
                     {"holes", holes},
                     {"gaps", gaps},
                     {"streams", rows_}});
}

}  // namespace baton
