/// The list of laws: one line each. The function named here is defined at the end of the law's own file.
#include <algorithm>

#include "base/error.hpp"
#include "control/law.hpp"
#include "control/nearest_name.hpp"

// clang-format off
#define BATON_LAWS(law)           \
  law(adaptive)                   \
  law(admittance)                 \
  law(compliance)                 \
  law(forcePi)                    \
  law(impedance)                  \
  law(jointInverseDynamics)       \
  law(jointPd)                    \
  law(operationalInverseDynamics) \
  law(operationalPd)              \
  law(parallelForcePosition)
// clang-format on

namespace baton {

namespace laws {
#define BATON_DECLARE(law) LawInfo law();
BATON_LAWS(BATON_DECLARE)
#undef BATON_DECLARE
}  // namespace laws

const std::vector<LawInfo>& allLaws() {
  static const std::vector<LawInfo> all = [] {
#define BATON_CALL(law) laws::law(),
    std::vector<LawInfo> list{BATON_LAWS(BATON_CALL)};
#undef BATON_CALL
    std::sort(list.begin(), list.end(), [](const LawInfo& a, const LawInfo& b) { return a.name < b.name; });
    return list;
  }();
  return all;
}

const LawInfo* lawCalled(std::string_view name) {
  const std::vector<LawInfo>& laws = allLaws();
  const auto found = std::find_if(laws.begin(), laws.end(), [&](const LawInfo& law) { return law.name == name; });
  return found == laws.end() ? nullptr : &*found;
}

const LawInfo& findLaw(const std::string& name) {
  if (const LawInfo* law = lawCalled(name)) return *law;
  std::vector<std::string> known;
  for (const LawInfo& law : allLaws()) known.push_back(law.name);
  throw UsageError(unknownName("law", name, known));
}

std::unique_ptr<Law> makeLaw(const std::string& name, const RobotModel& model, const ParameterValues& given) {
  const LawInfo& law = findLaw(name);
  try {
    return law.make(model, completeParameters(law.parameters, given, model.size()));
  } catch (const UsageError& error) {
    throw UsageError("law " + name + ": " + error.what());
  }
}

const char* toString(LawStatus status) {
  switch (status) {
    case LawStatus::kOk: return "ok";
    case LawStatus::kNotFinite: return "an input or the result is not finite";
    case LawStatus::kSingular: return "a singular configuration";
    case LawStatus::kMissingReference: return "the reference lacks the part that it follows";
  }
  return "unknown";
}

}  // namespace baton
