/// A recording written by a test: messages of idl/ or bytes of any type, each from a service.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "dds/codec.hpp"
#include "dds/topics.hpp"
#include "mcap/writer.hpp"
#include "msg/idl_text.hpp"

namespace baton::test {

class SmallRecording {
 public:
  explicit SmallRecording(const std::filesystem::path& path) : writer_(path, options()) {}

  /// A message of a topic of Baton's; each is recorded a millisecond after the one before.
  template <class T>
  void add(const dds::Topic<T>& topic, const std::string& service, const T& message) {
    for (const msg::IdlText& one : msg::allIdlTexts()) {
      if (one.type_name != topic.type) continue;
      std::vector<std::byte> buffer(dds::maxPayload<T>());
      return addBytes(topic.name, service, topic.type, one.text, dds::encode(message, std::span(buffer)));
    }
  }
  /// @param idl  empty for a topic without a schema.
  void addBytes(const std::string& topic, const std::string& service, const std::string& type, std::string_view idl,
                mcap::ByteView payload) {
    auto [channel, is_new] = channels_.try_emplace({topic, service, type});
    if (is_new) {
      const mcap::SchemaId schema =
          idl.empty() ? mcap::kNoSchema : writer_.addSchema(type, "omgidl", mcap::asBytes(idl));
      channel->second.id =
          writer_.addChannel(topic, "cdr", schema, {{"service", service}, {"writer", "of " + service}, {"type", type}});
    }
    time_ns_ += 1'000'000;
    writer_.write(channel->second.id, ++channel->second.sequence, time_ns_, time_ns_, payload);
  }
  void attach(const std::string& name, std::string_view text) {
    writer_.addAttachment(name, "text/plain", 0, 0, mcap::asBytes(text));
  }
  void close() { writer_.close(); }

 private:
  static mcap::WriterOptions options() {
    mcap::WriterOptions options;
    options.sync_on_close = false;
    options.if_exists = mcap::OutputFile::IfExists::kReplace;
    return options;
  }
  struct Channel {
    mcap::ChannelId id{};
    std::uint32_t sequence = 0;
  };
  mcap::Writer writer_;
  std::map<std::tuple<std::string, std::string, std::string>, Channel> channels_;
  std::uint64_t time_ns_ = 1'000'000'000;
};

/// A payload by hand: little-endian, aligned.
class Bytes {
 public:
  template <class Number>
  Bytes& number(Number value) {
    while ((bytes.size() - 4) % sizeof value != 0) bytes.push_back(std::byte{0});
    mcap::append(bytes, std::as_bytes(std::span(&value, 1)));
    return *this;
  }
  Bytes& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    mcap::append(bytes, mcap::asBytes(value));
    bytes.push_back(std::byte{0});
    return *this;
  }
  mcap::Bytes bytes{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
};

}  // namespace baton::test
