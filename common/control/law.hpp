/// What every controller is: a law that turns a state, a contact and a reference into joint efforts.
/// A law is one file under laws/ (equation, source, parameters, reset, step, handover) and one line in registry.cpp.
/// Two laws of the same structure share a class beside laws/ (tip_pd.hpp, force_control.hpp) and keep a file each.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/signals.hpp"
#include "base/state_archive.hpp"
#include "base/types.hpp"
#include "control/parameters.hpp"
#include "robot/model.hpp"

namespace baton {

/// Everything a law may know about a step.
struct LawInput {
  double dt_s = 0.0;  // length of a control step
  RobotState state;
  Contact contact;  // zero when the law does not use force
  Reference reference;
};

enum class LawStatus {
  kOk,
  kNotFinite,         // an input or the result is NaN or infinite
  kSingular,          // a matrix the law must solve has no inverse here
  kMissingReference,  // the reference lacks the part (joint or task) this law follows
};
[[nodiscard]] const char* toString(LawStatus status);

/// Life of a law: constructed once (may allocate, may throw UsageError); reset() at the start of a run; while it stands
/// by, handover() and step() at every step, so that its output is the effort it would command if it received the baton
/// there; from the step at which it holds the baton, step() alone.
/// reset, handover and step never throw, never allocate, and depend on nothing but their arguments and the law's state.
/// A law looks only at the inputs its equation needs, so a fault elsewhere (a NaN force, say) cannot stop a law that is
/// blind to it. Vectors of the state have n entries: whoever builds the input has checked that.
class Law {
 public:
  virtual ~Law() = default;

  /// Forget everything learnt: the state a new run starts from.
  virtual void reset() noexcept = 0;

  /// Initialise the law's state so that its effort at this input is as near to input.state.tau_applied as its structure
  /// allows, without losing what it has learnt. Laws without state do nothing.
  virtual void handover(const LawInput& input) noexcept = 0;

  /// Effort for this step. @param[out] tau n entries [N m or N]; left as it was unless the result is kOk.
  [[nodiscard]] virtual LawStatus step(const LawInput& input, JointVector& tau) noexcept = 0;

  /// Lists what the law remembers from step to step, for checkpoints. Laws without state list nothing.
  virtual void archive(StateArchive&) noexcept {}
};

/// A law as the registry lists it.
struct LawInfo {
  std::string name;                       // what --law and scenarios call it: "joint_pd"
  std::string summary;                    // one line for help texts
  bool uses_force = false;                // needs Contact(k): one more hop a step
  bool requires_contact = false;          // not fit to receive the baton out of contact
  std::vector<ParameterSpec> parameters;  // declared here once: name, unit, default, range
  std::function<std::unique_ptr<Law>(const RobotModel&, const ParameterValues&)> make;
};

/// All laws, sorted by name.
[[nodiscard]] const std::vector<LawInfo>& allLaws();

/// The law called `name`, nullptr when there is none.
[[nodiscard]] const LawInfo* lawCalled(std::string_view name);

/// The same; throws UsageError listing the known names.
[[nodiscard]] const LawInfo& findLaw(const std::string& name);

/// The law called `name` for this robot, defaults filled in; throws UsageError naming the law and what is wrong.
[[nodiscard]] std::unique_ptr<Law> makeLaw(const std::string& name, const RobotModel& model,
                                           const ParameterValues& given);

}  // namespace baton
