#include "recording.hpp"

#include <algorithm>

#include "dds/codec.hpp"
#include "dds/topics.hpp"

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

std::uint64_t lastTakeBegin(const mcap::Reader& reader) {
  std::uint64_t begin = 0;
  reader.forEachMessage({.topics = {dds::topics::kRewind.name}, .order = mcap::MessageFilter::Order::kFile},
                        [&](const mcap::MessageView& view) {
                          msg::Rewind rewind;
                          const bool commits = dds::decode(view.data, rewind) && rewind.phase() == msg::REWIND_COMMIT;
                          if (commits) begin = std::max(begin, view.log_time_ns);
                        });
  return begin;
}

}  // namespace baton
