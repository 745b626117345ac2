#include "runtime/recorded_extras.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "mcap/lookup.hpp"

namespace baton {
namespace {

std::optional<std::string> certificateText(const mcap::Source& reader) {
  std::optional<std::string> text = attachmentText(reader, "certificate.json");
  return text ? text : attachmentText(reader, "original_certificate.json");
}

}  // namespace

std::optional<std::string> attachmentText(const mcap::Source& reader, const std::string& name) {
  for (const mcap::AttachmentIndex& index : reader.attachments()) {
    if (index.name != name) continue;
    const mcap::Bytes data = reader.readAttachment(index);
    return std::string(reinterpret_cast<const char*>(data.data()), data.size());
  }
  return std::nullopt;
}

mcap::StringMap metadataOf(const mcap::Source& reader, const std::string& record) {
  mcap::StringMap values;
  for (const mcap::Metadata& one : reader.metadata()) {
    if (one.name == record) values.insert(one.values.begin(), one.values.end());
  }
  return values;
}

std::string metadataValue(const mcap::Source& reader, const std::string& record, const std::string& key) {
  return mcap::valueOf(metadataOf(reader, record), key);
}

unsigned firstPartKept(const mcap::Source& last_part) {
  try {
    const std::string text = attachmentText(last_part, "certificate.json").value_or("");
    const nlohmann::json certificate = nlohmann::json::parse(text, nullptr, false);
    const auto first = certificate.is_object() ? certificate.find("first_part") : certificate.end();
    return first != certificate.end() && first->is_number_unsigned() ? first->get<unsigned>() : 0;
  } catch (const mcap::FormatError&) {  // whoever reads what is certified says so
    return 0;
  }
}

bool hasTopic(const mcap::Source& reader, const std::string& topic) {
  const auto& counts = reader.statistics().channel_message_counts;
  return std::ranges::any_of(reader.channels(), [&](const auto& entry) {
    const auto count = counts.find(entry.first);
    return entry.second.topic == topic && count != counts.end() && count->second > 0;
  });
}

bool hasCertificate(const mcap::Source& reader) { return certificateText(reader).has_value(); }

bool isLeftOut(const mcap::Source& reader, const std::string& topic) {
  const nlohmann::json certificate = nlohmann::json::parse(certificateText(reader).value_or(""), nullptr, false);
  const auto listOf = [&](const char* key) {
    const auto list = certificate.is_object() ? certificate.find(key) : certificate.end();
    return list != certificate.end() && list->is_array() ? *list : nlohmann::json::array();
  };
  const nlohmann::json left_out = listOf("left_out"), streams = listOf("streams");
  if (std::count(left_out.begin(), left_out.end(), nlohmann::json(topic)) > 0) return true;
  if (metadataValue(reader, "baton.cut", "topics").empty()) return false;
  return std::any_of(streams.begin(), streams.end(), [&](const nlohmann::json& row) {
    return row.is_object() && row.value("topic", nlohmann::json()) == topic &&
           row.value("count", nlohmann::json()) != nlohmann::json(0);
  });
}

}  // namespace baton
