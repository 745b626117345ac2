#include "bag/field_rules.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/number.hpp"

namespace baton {
namespace {

/// "a[2].b[0]" as "a.b".
std::string withoutIndices(const std::string& path) {
  std::string field;
  bool is_inside = false;
  for (const char c : path) {
    if (c == '[') is_inside = true;
    if (!is_inside) field += c;
    if (c == ']') is_inside = false;
  }
  return field;
}

/// The member itself, or something in it; everything is in the empty one.
bool isIn(const std::string& path, const std::string& field) {
  return field.empty() || path == field ||
         (path.size() > field.size() && path.starts_with(field) && path[field.size()] == '.');
}

/// What a rule says about a topic: the field's name; nothing when it is about another topic.
std::optional<std::string> fieldFor(const std::string& rule, const std::string& topic, const schema::Type* type) {
  if (rule.empty()) return rule;
  if (type == nullptr) return std::nullopt;
  if (rule.starts_with(topic + ".") && hasField(*type, rule.substr(topic.size() + 1))) {
    return rule.substr(topic.size() + 1);
  }
  return hasField(*type, rule) ? std::optional(rule) : std::nullopt;
}

std::string numberOf(const std::string& tolerance) { return tolerance.substr(tolerance.find('=') + 1); }

/// Appends what stands between the commas. Two that together are a number with a decimal comma are refused: read one by
/// one, 0,5 would let everything be 5 apart.
void splitList(const std::string& list, std::vector<std::string>& each) {
  std::string before;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    each.push_back(list.substr(begin, end - begin));
    if (begin > 0) {
      const std::string both = numberOf(before) + "," + each.back();
      if (const std::string hint = commaHint(both); !hint.empty()) {
        throw UsageError("--tolerance: expected a distance, or several of fields, found '" + list + "'" + hint);
      }
    }
    before = each.back();
    begin = end + 1;
  }
}

}  // namespace

bool FieldRules::ignores(const std::string& path) const {
  if (ignored_.empty()) return false;
  const std::string field = withoutIndices(path);
  return std::ranges::any_of(ignored_, [&](const std::string& one) { return isIn(field, one); });
}

std::optional<double> FieldRules::tolerance(const std::string& path) const {
  const Tolerated* closest = nullptr;
  const std::string field = withoutIndices(path);
  for (const Tolerated& one : tolerated_) {
    const bool is_closer = closest == nullptr || one.field.size() >= closest->field.size();
    if (is_closer && isIn(field, one.field)) closest = &one;
  }
  return closest == nullptr ? std::nullopt : std::optional(closest->distance);
}

bool hasField(const schema::Type& type, const std::string& field) {
  const schema::Type* inner = &type;
  while (inner->element != nullptr) inner = inner->element;
  const std::size_t dot = field.find('.');
  const auto member = std::ranges::find(inner->members, field.substr(0, dot), &schema::Member::name);
  if (member == inner->members.end()) return false;
  return dot == std::string::npos || hasField(*member->type, field.substr(dot + 1));
}

RuleSet::RuleSet(std::vector<std::string> ignored, const std::vector<std::string>& tolerances) {
  for (std::string& name : ignored) ignored_.push_back({.name = std::move(name)});
  std::vector<std::string> each;
  for (const std::string& list : tolerances) splitList(list, each);
  for (const std::string& text : each) {
    const std::size_t equals = text.find('=');
    const std::string number = equals == std::string::npos ? text : text.substr(equals + 1);
    const auto distance = numberIn<double>(number);
    if (!distance || *distance < 0.0 || equals == 0) {
      throw UsageError("--tolerance: expected a distance of 0 or more, or field=distance, found '" + text + "'");
    }
    tolerances_.push_back({.name = equals == std::string::npos ? "" : text.substr(0, equals), .distance = *distance});
  }
}

bool RuleSet::ignoresTopic(const std::string& topic) const {
  return std::ranges::count(ignored_, topic, &Rule::name) > 0;
}

void RuleSet::meetTopic(const std::string& topic) {
  for (Rule& rule : ignored_) rule.is_met = rule.is_met || rule.name == topic;
}

FieldRules RuleSet::rulesFor(const std::string& topic, const schema::Type* type) {
  FieldRules rules;
  for (Rule& rule : ignored_) {
    if (const auto field = fieldFor(rule.name, topic, type)) {
      rules.ignore(*field);
      rule.is_met = true;
    }
  }
  // From what holds everywhere to what names the topic: of two for the same field the last one counts.
  for (const bool names_topic : {false, true}) {
    for (Rule& rule : tolerances_) {
      if (rule.name.starts_with(topic + ".") != names_topic) continue;
      if (const auto field = fieldFor(rule.name, topic, type)) {
        rules.tolerate(*field, rule.distance);
        rule.is_met = true;
      }
    }
  }
  // Bytes that may differ a little have other hashes.
  if (hasTolerance() && type != nullptr) {
    for (const schema::Member& member : type->members) {
      if (member.name.ends_with("_hash")) rules.ignore(member.name);
    }
  }
  return rules;
}

std::vector<std::string> RuleSet::unmet() const {
  std::vector<std::string> names;
  for (const auto* rules : {&ignored_, &tolerances_}) {
    for (const Rule& rule : *rules) {
      if (!rule.is_met) names.push_back(rule.name);
    }
  }
  return names;
}

}  // namespace baton
