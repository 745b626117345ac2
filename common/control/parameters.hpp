/// A law's parameters, declared once. The scenario reader, help texts and live changes all come from the declaration.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "base/types.hpp"

namespace baton {

/// How many numbers a parameter has. One number given stands for as many as are needed.
enum class ParameterSize {
  kScalar,
  kPerJoint,  // n numbers
  kThree,     // x, y, z
  kSix,       // linear x, y, z, then angular x, y, z
  kChoice     // one word out of `choices`
};

struct ParameterSpec {
  std::string name;  // as in YAML and on the command line, unit included where it has one
  std::string unit;  // "1/s^2", "N m/rad", "" for none
  std::string doc;   // one line
  ParameterSize size = ParameterSize::kScalar;
  std::vector<double> default_numbers;  // one entry, or as many as the size says
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  std::vector<std::string> choices;  // for kChoice; the first is the default
};

using ParameterValue = std::variant<std::vector<double>, std::string>;

/// Name to value, complete and within range once checked.
using ParameterValues = std::map<std::string, ParameterValue>;

/// Fills in defaults and checks sizes, ranges and names against the declaration; n is the joint count.
/// Throws UsageError saying what was expected and what was found.
[[nodiscard]] ParameterValues completeParameters(const std::vector<ParameterSpec>& specs, const ParameterValues& given,
                                                 int n);

/// The values of a checked set.
[[nodiscard]] const std::vector<double>& numbers(const ParameterValues& values, const std::string& name);
[[nodiscard]] double number(const ParameterValues& values, const std::string& name);
[[nodiscard]] const std::string& choice(const ParameterValues& values, const std::string& name);
/// As an Eigen vector: Vector3, Vector6 or JointVector.
template <typename Vector>
[[nodiscard]] Vector vector(const ParameterValues& values, const std::string& name) {
  const std::vector<double>& v = numbers(values, name);
  return Eigen::Map<const Vector>(v.data(), static_cast<Eigen::Index>(v.size()));
}

}  // namespace baton
