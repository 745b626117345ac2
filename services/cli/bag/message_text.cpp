#include "bag/message_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "mcap/lookup.hpp"
#include "runtime/recorded_types.hpp"
#include "schema/error.hpp"

namespace baton {
namespace {

template <class Number>
std::string numberText(Number value) {
  if constexpr (std::is_floating_point_v<Number>) {
    if (std::isnan(value)) return "NaN";
    if (std::isinf(value)) return value > 0 ? "Infinity" : "-Infinity";
  }
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  std::string text(buffer.data(), end);
  if constexpr (std::is_floating_point_v<Number>) {
    // Else it would be read as an integer, which knows no -0.
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
  }
  return text;
}

bool isText(const schema::Type& type, const schema::Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return !std::isfinite(*number);
  if (const auto* number = std::get_if<float>(&value)) return !std::isfinite(*number);
  if (const auto* number = std::get_if<std::int64_t>(&value)) return !schema::enumeratorName(type, *number).empty();
  return std::holds_alternative<std::string_view>(value) || std::holds_alternative<schema::Bytes>(value);
}

void appendMember(std::string& out, std::string_view name, std::string_view value) {
  appendJsonString(out, name);
  out += ':';
  if (value.empty()) {
    out += "null";
  } else {
    appendJsonString(out, value);
  }
  out += ',';
}

/// Leaves what it has written when it throws PayloadError.
void appendJson(std::string& out, const schema::Type& type, schema::Bytes payload) {
  schema::MessageReader reader(type, payload);
  for (schema::Item item; reader.next(item);) {
    const bool is_list = item.type->kind == schema::Kind::kSequence || item.type->kind == schema::Kind::kArray;
    if (item.what == schema::Item::What::kEnd) {
      out += is_list ? ']' : '}';
      continue;
    }
    if (item.index > 0) out += ',';
    if (item.member != nullptr) {
      appendJsonString(out, item.member->name);
      out += ':';
    }
    if (item.what == schema::Item::What::kBegin) {
      out += is_list ? '[' : '{';
    } else if (isText(*item.type, item.value)) {
      appendJsonString(out, plainText(*item.type, item.value));
    } else {
      out += plainText(*item.type, item.value);
    }
  }
}

}  // namespace

std::string hexOf(schema::Bytes bytes) {
  static constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  text.reserve(bytes.size() * 2);
  for (const std::byte byte : bytes) {
    text += kDigits[static_cast<std::size_t>(byte >> 4)];
    text += kDigits[static_cast<std::size_t>(byte & std::byte{15})];
  }
  return text;
}

std::string plainText(const schema::Type& type, const schema::Value& value, bool is_number) {
  struct Text {
    const schema::Type& type;
    bool is_number;
    std::string operator()(bool flag) const { return is_number ? (flag ? "1" : "0") : (flag ? "true" : "false"); }
    std::string operator()(std::int64_t number) const {
      const std::string_view name = schema::enumeratorName(type, number);
      return name.empty() ? numberText(number) : std::string(name);
    }
    std::string operator()(std::uint64_t number) const { return numberText(number); }
    std::string operator()(float number) const { return numberText(number); }
    std::string operator()(double number) const { return numberText(number); }
    std::string operator()(std::string_view text) const { return std::string(text); }
    std::string operator()(schema::Bytes bytes) const { return hexOf(bytes); }
  };
  return std::visit(Text{type, is_number}, value);
}

void appendJsonString(std::string& out, std::string_view text) {
  const bool is_simple =
      std::ranges::all_of(text, [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; });
  if (is_simple) {
    ((out += '"') += text) += '"';
  } else {
    out += escapedInJson(nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  }
}

std::string appendJsonLine(std::string& out, const mcap::MessageView& message, const schema::Type* type) {
  const mcap::Channel& channel = *message.channel;
  out += '{';
  appendMember(out, "topic", channel.topic);
  appendMember(out, "service", serviceOf(channel));
  appendMember(out, "writer", mcap::valueOf(channel.metadata, "writer"));
  out += "\"sequence\":" + std::to_string(message.sequence) +
         ",\"log_time_ns\":" + std::to_string(message.log_time_ns) +
         ",\"publish_time_ns\":" + std::to_string(message.publish_time_ns) + ",";
  appendMember(out, "type", typeNameOf(message));
  std::string problem;
  if (type != nullptr) {
    const std::size_t before = out.size();
    out += "\"message\":";
    try {
      appendJson(out, *type, message.data);
      out += '}';
      return {};
    } catch (const schema::PayloadError& error) {
      out.resize(before);
      problem = error.what();
      appendMember(out, "error", problem);
    }
  }
  out += "\"data\":\"" + hexOf(message.data) + "\"}";
  return problem;
}

}  // namespace baton
