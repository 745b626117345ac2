#include "raw_roles.hpp"

#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>

#include "msg/loopPubSubTypes.h"

namespace raw {
namespace {
namespace msg = baton::msg;

constexpr const char* kState = "plant_state";
constexpr const char* kContact = "contact";
constexpr const char* kReference = "reference";
constexpr const char* kCommand = "joint_command";
constexpr std::int64_t kStep_ns = 500'000;
constexpr std::size_t kJoints = 3;

// What the numbers in the messages are, so that each tells of the step and the sample it comes from.
double positionAt(std::uint64_t step) { return static_cast<double>(step); }
double referenceAt(std::uint64_t step) { return 2.0 * static_cast<double>(step); }
double effortOf(double reference, double position, double force) { return reference - position + force; }

/// In a receive thread there is nobody to catch: the process ends, and with it the chain.
[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "baton-raw-chain: %s\n", what.c_str());
  _exit(1);
}

/// Steps come one after the other, none twice, none left out.
class Sequence {
 public:
  explicit Sequence(const char* what) : what_(what) {}
  void accept(std::uint64_t step) {
    if (step != next_) {
      fail(std::string(what_) + ": expected step " + std::to_string(next_) + ", found " + std::to_string(step));
    }
    ++next_;
  }
  [[nodiscard]] std::uint64_t count() const { return next_; }
  [[nodiscard]] bool has(std::uint64_t step) const { return step < next_; }

 private:
  const char* what_;
  std::uint64_t next_ = 0;
};

template <class Message>
void stamp(Message& message, std::uint64_t step) {
  message.step(step);
  message.time_ns(static_cast<std::int64_t>(step) * kStep_ns);
}

void write(dds::DataWriter* writer, void* message) {
  if (!baton::fastdds::isDone(writer->write(message))) fail("DDS refused a sample");
}

class ChainPlant final : public Plant {
 public:
  explicit ChainPlant(const Chain& chain)
      : chain_(chain), openings_(chain.warm_up + chain.steps + 1), node_(chain.network) {
    opened_ns_.reserve(openings_);
    state_.position().resize(kJoints);
    state_.velocity().resize(kJoints);
    state_.applied_effort().resize(kJoints);
    state_.holder("controller");
    out_ = node_.writer<msg::PlantStatePubSubType>(kState, chain.observed ? 4 : 3);
    node_.reader<msg::ContactPubSubType>(kContact, [this](const msg::Contact& contact) { onContact(contact); });
    node_.reader<msg::JointCommandPubSubType>(kCommand,
                                              [this](const msg::JointCommand& command) { onCommand(command); });
  }

  void awaitMatches() const override { node_.awaitMatches(); }

  std::vector<std::int64_t> run() override {
    std::unique_lock lock(mutex_);
    open();
    done_.wait(lock, [&] { return opened_ns_.size() == openings_; });
    std::vector<std::int64_t> periods_ns;
    for (std::size_t k = chain_.warm_up; k + 1 < opened_ns_.size(); ++k) {
      periods_ns.push_back(opened_ns_[k + 1] - opened_ns_[k]);
    }
    return periods_ns;
  }

 private:
  void onContact(const msg::Contact& contact) {
    const std::lock_guard lock(mutex_);
    contacts_.accept(contact.step());
    advance();
  }

  void onCommand(const msg::JointCommand& command) {
    const std::lock_guard lock(mutex_);
    const std::uint64_t step = command.step();
    commands_.accept(step);
    const double force = chain_.hops == 3 ? positionAt(step) : 0.0;
    for (const double effort : command.effort()) {
      if (effort != effortOf(referenceAt(step), positionAt(step), force))
        fail("command: its effort does not come from the samples of step " + std::to_string(step));
    }
    state_.applied_effort(command.effort());
    advance();
  }

  void advance() {
    if (contacts_.count() == step_ + 1 && commands_.count() == step_ + 1) {
      ++step_;
      open();
    }
  }

  void open() {
    using namespace std::chrono;
    opened_ns_.push_back(duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count());
    if (opened_ns_.size() == openings_) return done_.notify_one();
    stamp(state_, step_);
    state_.position().assign(kJoints, positionAt(step_));
    write(out_, &state_);
  }

  Chain chain_;
  std::mutex mutex_;
  std::condition_variable done_;
  const std::size_t openings_;  // of all steps, and of the one after the last
  std::vector<std::int64_t> opened_ns_;
  std::uint64_t step_ = 0;
  Sequence contacts_{"contact"};
  Sequence commands_{"command"};
  msg::PlantState state_;
  dds::DataWriter* out_ = nullptr;
  Node node_;  // last: it goes first, and with it the listeners
};

class Environment final : public Role {
 public:
  explicit Environment(const Chain& chain) : node_(chain.network) {
    out_ = node_.writer<msg::ContactPubSubType>(kContact, 1 + (chain.hops == 3 ? 1 : 0) + (chain.observed ? 1 : 0));
    node_.reader<msg::PlantStatePubSubType>(kState, [this](const msg::PlantState& state) {
      states_.accept(state.step());
      stamp(contact_, state.step());
      contact_.force()[0] = state.position()[0];
      write(out_, &contact_);
    });
  }
  void awaitMatches() const override { node_.awaitMatches(); }

 private:
  Sequence states_{"state"};
  msg::Contact contact_;
  dds::DataWriter* out_ = nullptr;
  Node node_;
};

class Trajectory final : public Role {
 public:
  explicit Trajectory(const Chain& chain) : node_(chain.network) {
    for (auto* joints : {&reference_.position(), &reference_.velocity(), &reference_.acceleration()}) {
      joints->resize(kJoints);
    }
    reference_.has_task(true);
    out_ = node_.writer<msg::ReferencePubSubType>(kReference, chain.observed ? 2 : 1);
    node_.reader<msg::PlantStatePubSubType>(kState, [this](const msg::PlantState& state) {
      states_.accept(state.step());
      if (state.step() == 0) publish(0);
      publish(state.step() + 1);
    });
  }
  void awaitMatches() const override { node_.awaitMatches(); }

 private:
  void publish(std::uint64_t step) {
    stamp(reference_, step);
    reference_.position().assign(kJoints, referenceAt(step));
    write(out_, &reference_);
  }

  Sequence states_{"state"};
  msg::Reference reference_;
  dds::DataWriter* out_ = nullptr;
  Node node_;
};

class Controller final : public Role {
 public:
  explicit Controller(const Chain& chain) : needs_contact_(chain.hops == 3), node_(chain.network) {
    command_.controller("controller");
    command_.effort().resize(kJoints);
    out_ = node_.writer<msg::JointCommandPubSubType>(kCommand, chain.observed ? 2 : 1);
    node_.reader<msg::PlantStatePubSubType>(kState, [this](const msg::PlantState& state) {
      const std::lock_guard lock(mutex_);
      states_.accept(state.step());
      state_ = state;
      answer();
    });
    node_.reader<msg::ReferencePubSubType>(kReference, [this](const msg::Reference& reference) {
      const std::lock_guard lock(mutex_);
      references_.accept(reference.step());
      reference_[reference.step() % 2] = reference;
      answer();
    });
    if (!needs_contact_) return;
    node_.reader<msg::ContactPubSubType>(kContact, [this](const msg::Contact& contact) {
      const std::lock_guard lock(mutex_);
      contacts_.accept(contact.step());
      contact_ = contact;
      answer();
    });
  }
  void awaitMatches() const override { node_.awaitMatches(); }

 private:
  void answer() {
    if (!states_.has(step_) || !references_.has(step_) || (needs_contact_ && !contacts_.has(step_))) return;
    stamp(command_, step_);
    const msg::Reference& reference = reference_[step_ % 2];
    for (std::size_t i = 0; i < kJoints; ++i) {
      command_.effort()[i] = effortOf(reference.position()[i], state_.position()[i], contact_.force()[0]);
    }
    ++step_;
    write(out_, &command_);
  }

  const bool needs_contact_;
  std::mutex mutex_;
  std::uint64_t step_ = 0;  // to be answered next
  Sequence states_{"state"};
  Sequence references_{"reference"};
  Sequence contacts_{"contact"};
  msg::PlantState state_;
  std::array<msg::Reference, 2> reference_;  // of the open step and the next; by parity
  msg::Contact contact_;
  msg::JointCommand command_;
  dds::DataWriter* out_ = nullptr;
  Node node_;
};

/// Reads everything, as a recorder would.
class Observer final : public Role {
 public:
  explicit Observer(const Chain& chain) : node_(chain.network) {
    node_.reader<msg::PlantStatePubSubType>(kState, [this](const auto& state) { states_.accept(state.step()); });
    node_.reader<msg::ContactPubSubType>(kContact, [this](const auto& contact) { contacts_.accept(contact.step()); });
    node_.reader<msg::ReferencePubSubType>(kReference,
                                           [this](const auto& reference) { references_.accept(reference.step()); });
    node_.reader<msg::JointCommandPubSubType>(kCommand,
                                              [this](const auto& command) { commands_.accept(command.step()); });
  }
  void awaitMatches() const override { node_.awaitMatches(); }

 private:
  Sequence states_{"state"};
  Sequence contacts_{"contact"};
  Sequence references_{"reference"};
  Sequence commands_{"command"};
  Node node_;
};

}  // namespace

std::unique_ptr<Plant> makePlant(const Chain& chain) { return std::make_unique<ChainPlant>(chain); }
std::unique_ptr<Role> makeEnvironment(const Chain& chain) { return std::make_unique<Environment>(chain); }
std::unique_ptr<Role> makeTrajectory(const Chain& chain) { return std::make_unique<Trajectory>(chain); }
std::unique_ptr<Role> makeController(const Chain& chain) { return std::make_unique<Controller>(chain); }
std::unique_ptr<Role> makeObserver(const Chain& chain) { return std::make_unique<Observer>(chain); }

}  // namespace raw
