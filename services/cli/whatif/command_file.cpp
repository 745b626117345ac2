#include "command_file.hpp"

#include <algorithm>
#include <span>

#include "dds/codec.hpp"
#include "messages/loop.hpp"
#include "msg/idl_text.hpp"

namespace baton {
namespace {

mcap::WriterOptions fileOptions() {
  mcap::WriterOptions options;
  options.library = "baton " BATON_VERSION;
  options.if_exists = mcap::OutputFile::IfExists::kReplace;
  return options;
}

mcap::ChannelId channelIn(mcap::Writer& writer) {
  const auto texts = msg::allIdlTexts();
  const auto idl =
      std::find_if(texts.begin(), texts.end(), [](const auto& text) { return text.type_name == CommandFile::kType; });
  const mcap::SchemaId schema = writer.addSchema(CommandFile::kType, "omgidl", std::as_bytes(std::span(idl->text)));
  return writer.addChannel(CommandFile::kTopic, "cdr", schema, {{"type", CommandFile::kType}, {"service", "whatif"}});
}

}  // namespace

CommandFile::CommandFile(const std::filesystem::path& file, const std::string& controller, std::int64_t step_ns)
    : controller_(controller),
      step_ns_(step_ns),
      writer_(file, fileOptions()),
      channel_(channelIn(writer_)),
      buffer_(dds::maxPayload<msg::JointCommand>()) {
  prepare(message_);
}

void CommandFile::write(const RecordedStep& step, const JointVector& effort, std::uint64_t inputs_hash) {
  toMessage(stampOf(step.step, step_ns_), controller_, effort, inputs_hash, message_);
  log_time_ns_ = std::max(log_time_ns_, step.log_time_ns);
  writer_.write(channel_, ++sequence_, log_time_ns_, step.publish_time_ns, dds::encode(message_, std::span(buffer_)));
}

void CommandFile::close(const mcap::StringMap& about) {
  writer_.addMetadata("baton.whatif", about);
  writer_.close();
}

}  // namespace baton
