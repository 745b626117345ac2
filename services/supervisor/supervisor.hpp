/// A run from its first process to its last. Starts what the scenario names, tells the plant when one of them dies,
/// waits for the recording to be closed, ends the rest, and writes result.json into the run's folder.
#pragma once

#include <atomic>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "runtime/cell.hpp"
#include "runtime/child.hpp"
#include "runtime/service.hpp"

namespace baton {

struct Deployment {
  RunInfo info;
  int restarts = 0;  // how often each part that dies, but plant and recorder, is started again
};

class Supervisor {
 public:
  Supervisor(Service& service, Deployment deployment);

  /// Until the run is over and every child is gone.
  ExitCode run();

 private:
  enum class Stage { kRunning, kClosingRecording, kStopping };

  void startAll();
  void limitStart();
  [[nodiscard]] std::string whatTheStartWaitsFor();
  void start(const std::string& role, const std::string& name, const std::string& law);
  void childEnded(Child& child, const Child::End& end);
  void judgeWhenBegun(Child& child, const Child::End& end, int looks);
  void endedAfterTheRun(const Child& child, const Child::End& end);
  void childFailed(Child& child, const Child::End& end);
  void judge(const msg::SwapOutcome& swap);
  void endForThePlant();
  void fail(ExitCode code, const std::string& reason);
  void restart(const std::string& name);
  // launch.cpp: controllers that come and go while it runs
  void onLaunchRequest(const msg::LaunchRequest& request);
  [[nodiscard]] msg::LaunchReply startController(const msg::LaunchRequest& request);
  [[nodiscard]] msg::LaunchReply stopController(const msg::LaunchRequest& request);
  [[nodiscard]] Child* runningChild(const std::string& name);
  void onSimStatus(const msg::SimStatus& status);
  [[nodiscard]] msg::SimStatus lastSimStatus();
  [[nodiscard]] msg::BatonStatus lastBatonStatus();
  void onSignal();
  void considerAbort();
  void runIsOver();
  void stopChildren();
  void enter(Stage stage, std::chrono::seconds patience);
  void giveUpWaiting();
  [[nodiscard]] bool anyRunning() const;
  [[nodiscard]] bool isRunning(const std::string& name) const;

  Service& service_;
  Deployment deployment_;
  Scenario scenario_;                         // with the controllers that were started since
  std::map<std::string, std::string> roles_;  // of services, by name
  std::map<std::string, int> restarts_left_;
  std::set<std::string, std::less<>> asked_to_end_;
  std::vector<std::unique_ptr<Child>> children_;
  boost::asio::steady_timer start_limit_;
  boost::asio::steady_timer patience_;
  bool has_spared_recorder_ = false;
  bool has_killed_ = false;  // who did not end when asked to
  Stage stage_ = Stage::kRunning;
  ExitCode exit_code_ = ExitCode::kOk;
  std::string reason_;

  // What happened, for the result. The samples come under the service's lock.
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  std::atomic<double> startup_s_{-1.0};
  msg::SimStatus sim_;
  msg::TimingStatus timing_;
  msg::BatonStatus baton_;
  msg::RecorderStatus recorder_;
  std::vector<msg::SwapOutcome> swaps_;
  std::vector<msg::SwapReport> reports_;
  std::map<std::string, long> resident_;  // [kB], by service

  // On behalf of a child that died; a writer each, so that no death replaces another's word.
  std::map<std::string, dds::Writer<msg::ServiceStatus>*> status_out_;
  dds::Writer<msg::SimStatus>& sim_out_;  // on behalf of a plant that died
  dds::Writer<msg::SimRequest>& request_out_;
  dds::Writer<msg::LaunchReply>& launch_out_;
};

}  // namespace baton
