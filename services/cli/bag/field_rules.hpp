/// What `bag diff` leaves out and how far values may be apart: --ignore and --tolerance.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "schema/type.hpp"

namespace baton {

/// The rules that hold for one topic. Fields are named without indices: "tip_position", "parameters.numbers"; a rule
/// for a member holds for everything in it.
class FieldRules {
 public:
  void ignore(const std::string& field) { ignored_.push_back(field); }
  /// @param field  empty for every field; a longer name goes before a shorter one.
  void tolerate(const std::string& field, double distance) { tolerated_.push_back({field, distance}); }

  [[nodiscard]] bool empty() const { return ignored_.empty() && tolerated_.empty(); }
  /// @param path  of a value, with or without indices.
  [[nodiscard]] bool ignores(const std::string& path) const;
  /// How far two values may be apart; nothing when they must be the same bit by bit.
  [[nodiscard]] std::optional<double> tolerance(const std::string& path) const;

 private:
  struct Tolerated {
    std::string field;
    double distance;
  };
  std::vector<std::string> ignored_;
  std::vector<Tolerated> tolerated_;
};

/// Whether a message of the type can have such a field.
[[nodiscard]] bool hasField(const schema::Type& type, const std::string& field);

/// The rules of a command line, for each topic. A rule names a topic's field ("contact.force"), a field in any topic
/// ("force") or, to be ignored, a topic.
class RuleSet {
 public:
  /// @param tolerances  "field=distance", or a distance for every field.
  /// Throws UsageError for a tolerance that is none.
  RuleSet(std::vector<std::string> ignored, const std::vector<std::string>& tolerances);

  [[nodiscard]] bool ignoresTopic(const std::string& topic) const;
  /// @param type  null for one whose messages stay bytes.
  [[nodiscard]] FieldRules rulesFor(const std::string& topic, const schema::Type* type);
  [[nodiscard]] bool hasTolerance() const { return !tolerances_.empty(); }
  /// Rules that have met nothing they are about so far.
  [[nodiscard]] std::vector<std::string> unmet() const;
  void meetTopic(const std::string& topic);

 private:
  struct Rule {
    std::string name;
    double distance = 0.0;  // of a tolerance
    bool is_met = false;
  };
  std::vector<Rule> ignored_;
  std::vector<Rule> tolerances_;
};

}  // namespace baton
