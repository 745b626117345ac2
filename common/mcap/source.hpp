/// What can be asked of a recording, whether it is one file or several that are read as one.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "mcap/cursor.hpp"

namespace baton::mcap {

class Source {
 public:
  virtual ~Source() = default;

  /// Whether it is complete, and if not where it was cut and why.
  [[nodiscard]] virtual const FileInfo& info() const = 0;
  [[nodiscard]] virtual const std::map<SchemaId, Schema>& schemas() const = 0;
  [[nodiscard]] virtual const std::map<ChannelId, Channel>& channels() const = 0;
  /// Counts in all and per channel, first and last log time; of what is readable, when it was cut.
  [[nodiscard]] virtual const Statistics& statistics() const = 0;
  [[nodiscard]] virtual const std::vector<AttachmentIndex>& attachments() const = 0;
  /// An attachment's data. Throws FormatError when its CRC or its lengths are wrong.
  /// @param attachment  one of attachments().
  [[nodiscard]] virtual Bytes readAttachment(const AttachmentIndex& attachment) const = 0;
  /// All metadata records, in file order. Throws FormatError when one is damaged.
  [[nodiscard]] virtual std::vector<Metadata> metadata() const = 0;
  /// The messages that pass the filter, each given to the callback.
  virtual void forEachMessage(const MessageFilter& filter,
                              const std::function<void(const MessageView&)>& callback) const = 0;
};

}  // namespace baton::mcap
