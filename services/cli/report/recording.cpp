#include "recording.hpp"

namespace baton {

std::optional<std::string> attachmentText(const mcap::Reader& reader, const std::string& name) {
  for (const mcap::AttachmentIndex& index : reader.attachments()) {
    if (index.name != name) continue;
    const mcap::Bytes data = reader.readAttachment(index);
    return std::string(reinterpret_cast<const char*>(data.data()), data.size());
  }
  return std::nullopt;
}

std::string metadataValue(const mcap::Reader& reader, const std::string& record, const std::string& key) {
  for (const mcap::Metadata& one : reader.metadata()) {
    if (one.name != record) continue;
    if (const auto found = one.values.find(key); found != one.values.end()) return found->second;
  }
  return {};
}

bool isCertified(const mcap::Reader& reader) {
  return metadataValue(reader, "baton.certificate", "complete") == "true";
}

}  // namespace baton
