#include "cell_client.hpp"

#include <unistd.h>

#include <random>

namespace baton {

CellClient::CellClient(const RunInfo& info)
    : info_(info),
      participant_(dds::ParticipantOptions{.domain = info.domain,
                                           .partition = info.cell + "/" + info.run,
                                           .cell = info.cell,
                                           .run = info.run,
                                           .service = "operator-" + std::to_string(getpid()),
                                           .transport = info.transport},
                   [this](const dds::Peer&) {
                     const std::lock_guard lock(mutex_);
                     changed_.notify_all();
                   }) {}

RunInfo CellClient::find(int domain, const std::string& cell) {
  if (const std::optional<RunInfo> run = activeRun(domain, cell)) return *run;
  std::string others;
  for (const RunInfo& run : activeRuns()) {
    others += (others.empty() ? "" : ", ") + ("--cell " + run.cell + " --domain " + std::to_string(run.domain));
  }
  throw UnavailableError("nothing runs in cell " + cell + " of domain " + std::to_string(domain) +
                         (others.empty() ? ": start a scenario with `baton up SCENARIO`" : "; there is: " + others));
}

std::uint64_t CellClient::newRequestId() {
  std::random_device device;
  return (std::uint64_t{device()} << 32 | device()) | 1;  // 0 means planned by the scenario
}

bool CellClient::isMatchedWith(const std::set<dds::GuidPrefix>& matched, const std::string& service) const {
  for (const dds::GuidPrefix& prefix : matched) {
    if (const auto peer = participant_.peer(prefix); peer && peer->service == service) return true;
  }
  return false;
}

}  // namespace baton
