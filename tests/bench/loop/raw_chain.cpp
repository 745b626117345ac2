#include "raw_chain.hpp"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench/statistics.hpp"

namespace raw {
namespace {

constexpr int kPatience_ms = 60'000;

/// A forked role. It says "r" when it is matched with all others; a plant that is told "g" runs and says "d".
struct Process {
  std::string name;
  pid_t pid = -1;
  int socket = -1;
};

/// Both return false when the other side is gone.
[[nodiscard]] bool tell(int socket, char word) { return send(socket, &word, 1, MSG_NOSIGNAL) == 1; }
[[nodiscard]] bool hear(int socket) {
  char word = 0;
  return read(socket, &word, 1) == 1;
}

nlohmann::ordered_json resultOf(const Chain& chain, std::vector<std::int64_t> periods_ns) {
  std::sort(periods_ns.begin(), periods_ns.end());
  const auto us = [](double ns) { return ns * 1e-3; };
  const auto quantile_us = [&](double part) {
    return us(static_cast<double>(baton::bench::quantile(periods_ns, part)));
  };
  double sum_ns = 0.0;
  for (const std::int64_t period_ns : periods_ns) sum_ns += static_cast<double>(period_ns);
  return {{"hops", chain.hops},
          {"transport", chain.network.shared_memory ? "shm" : "udp"},
          {"processes", chain.observed ? 5 : 4},
          {"period_us",
           {{"count", periods_ns.size()},
            {"mean", us(sum_ns / static_cast<double>(periods_ns.size()))},
            {"p50", quantile_us(0.5)},
            {"p99", quantile_us(0.99)},
            {"p999", quantile_us(0.999)},
            {"max", quantile_us(1.0)}}}};
}

/// The life of a role, in its own process, until the launcher closes the other end of the socket.
void serve(const std::string& name, const Chain& chain, int socket) {
  std::unique_ptr<Role> role;
  Plant* plant = nullptr;
  if (name == "plant") {
    auto made = makePlant(chain);
    plant = made.get();
    role = std::move(made);
  } else if (name == "environment") {
    role = makeEnvironment(chain);
  } else if (name == "trajectory") {
    role = makeTrajectory(chain);
  } else if (name == "controller") {
    role = makeController(chain);
  } else {
    role = makeObserver(chain);
  }
  role->awaitMatches();
  if (!tell(socket, 'r')) return;
  if (plant != nullptr && hear(socket)) {
    std::cout << resultOf(chain, plant->run()).dump(1) << std::endl;
    if (!tell(socket, 'd')) return;
  }
  while (hear(socket)) continue;
}

Process launch(const std::string& name, const Chain& chain, const std::vector<Process>& before) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throw std::runtime_error("no socket pair");
  const pid_t pid = fork();
  if (pid < 0) throw std::runtime_error("fork failed");
  if (pid > 0) {
    close(ends[1]);
    return {name, pid, ends[0]};
  }
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  // The launcher's ends: while a copy is open here, the others would not see it close.
  close(ends[0]);
  for (const Process& other : before) close(other.socket);
  int exit_code = 0;
  try {
    serve(name, chain, ends[1]);
  } catch (const std::exception& error) {
    std::cerr << "baton-raw-chain: " << name << ": " << error.what() << '\n';
    exit_code = 1;
  }
  std::exit(exit_code);
}

/// Waits for the next word of each of `awaited`, in any order. Throws when one of all is gone or nothing happens.
void awaitWords(std::vector<std::string> awaited, const std::vector<Process>& all) {
  while (!awaited.empty()) {
    std::vector<pollfd> sockets;
    sockets.reserve(all.size());
    for (const Process& process : all) sockets.push_back({process.socket, POLLIN, 0});
    if (poll(sockets.data(), sockets.size(), kPatience_ms) <= 0) {
      throw std::runtime_error("the chain does not get on: it waits for " + awaited.front());
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (sockets[i].revents == 0) continue;
      if (!hear(all[i].socket)) throw std::runtime_error(all[i].name + " ended early");
      std::erase(awaited, all[i].name);
    }
  }
}

}  // namespace

void runChain(const Chain& chain) {
  std::vector<std::string> names{"environment", "trajectory", "controller", "plant"};
  if (chain.observed) names.insert(names.begin(), "observer");
  std::vector<Process> all;
  std::string problem;
  try {
    for (const std::string& name : names) all.push_back(launch(name, chain, all));
    awaitWords(names, all);
    if (!tell(all.back().socket, 'g')) throw std::runtime_error("the plant ended early");
    awaitWords({"plant"}, all);
  } catch (const std::exception& error) {
    problem = error.what();
    for (const Process& process : all) kill(process.pid, SIGKILL);
  }
  for (const Process& process : all) close(process.socket);
  for (const Process& process : all) {
    int how = 0;
    waitpid(process.pid, &how, 0);
    if (how != 0 && problem.empty()) problem = process.name + " did not end well";
  }
  if (!problem.empty()) throw std::runtime_error(problem);
}

}  // namespace raw
