/// The types of a recording's messages, from the IDL text it carries.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "mcap/reader.hpp"
#include "schema/type.hpp"

namespace baton {

/// The message's type as the channel's metadata or the schema names it; empty when neither does.
[[nodiscard]] std::string typeNameOf(const mcap::Channel& channel, const mcap::Schema* schema);
[[nodiscard]] inline std::string typeNameOf(const mcap::MessageView& message) {
  return typeNameOf(*message.channel, message.schema);
}

/// The service that published on the channel; empty when the recording does not say.
[[nodiscard]] std::string serviceOf(const mcap::Channel& channel);

class RecordedTypes {
 public:
  /// @param complain  is told, once a topic, why the messages of a channel stay bytes although it has a schema.
  explicit RecordedTypes(std::function<void(const std::string&)> complain) : complain_(std::move(complain)) {}

  /// Null when the messages of the channel cannot be decoded. Valid as long as this.
  [[nodiscard]] const schema::Type* typeOf(const mcap::Channel& channel, const mcap::Schema* schema);
  [[nodiscard]] const schema::Type* typeOf(const mcap::MessageView& message) {
    return typeOf(*message.channel, message.schema);
  }

 private:
  /// What has become of a schema's text, which is read once however many channels have it.
  struct Parsed {
    schema::TypeSet types;
    std::string problem;  // why there are no types
  };
  [[nodiscard]] const Parsed& parsed(const mcap::Schema& schema);
  [[nodiscard]] const schema::Type* read(const mcap::Channel& channel, const mcap::Schema& schema);

  std::function<void(const std::string&)> complain_;
  std::map<mcap::SchemaId, Parsed> parsed_;
  std::map<mcap::ChannelId, const schema::Type*> types_;
};

}  // namespace baton
