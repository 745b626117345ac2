#include "runtime/recorded_types.hpp"

#include <string_view>

#include "base/error.hpp"
#include "mcap/lookup.hpp"
#include "schema/error.hpp"
#include "schema/idl_parser.hpp"

namespace baton {

std::string typeNameOf(const mcap::Channel& channel, const mcap::Schema* schema) {
  return schema != nullptr ? schema->name : mcap::valueOf(channel.metadata, "type");
}

std::string serviceOf(const mcap::Channel& channel) { return mcap::valueOf(channel.metadata, "service"); }

const schema::Type* RecordedTypes::typeOf(const mcap::Channel& channel, const mcap::Schema* schema) {
  const auto [known, is_new] = types_.try_emplace(channel.id, nullptr);
  if (!is_new || (schema == nullptr && channel.schema_id == mcap::kNoSchema)) return known->second;
  try {
    if (schema == nullptr) throw UsageError("its schema is declared nowhere in the recording");
    known->second = read(channel, *schema);
  } catch (const UsageError& error) {
    complain_("topic " + channel.topic + " stays bytes: " + error.what());
  }
  return known->second;
}

const RecordedTypes::Parsed& RecordedTypes::parsed(const mcap::Schema& schema) {
  const auto [known, is_new] = parsed_.try_emplace(schema.id);
  if (!is_new) return known->second;
  try {
    const std::string_view text(reinterpret_cast<const char*>(schema.data.data()), schema.data.size());
    known->second.types = schema::parseIdl(text);
  } catch (const schema::IdlError& error) {
    known->second.problem = "the text of schema " + schema.name + ", " + error.what();
  }
  return known->second;
}

const schema::Type* RecordedTypes::read(const mcap::Channel& channel, const mcap::Schema& schema) {
  if (channel.message_encoding != "cdr" || schema.encoding != "omgidl") {
    throw UsageError("expected messages in cdr with a schema in omgidl, found " + channel.message_encoding + " with " +
                     schema.encoding);
  }
  const Parsed& text = parsed(schema);
  if (!text.problem.empty()) throw UsageError(text.problem);
  if (const schema::Type* type = text.types.find(schema.name)) return type;
  const auto& problems = text.types.problems();
  const schema::Problem* problem = text.types.problemOf(schema.name);
  if (problem != nullptr) {
    throw UsageError("the text of schema " + schema.name + ", definition of " + problem->definition + ", " +
                     problem->text);
  }
  throw UsageError("expected the type " + (schema.name.empty() ? "''" : schema.name) +
                   " in its schema's text, found it nowhere" +
                   (problems.empty() ? "" : "; what cannot be read there: " + problems.front().text));
}

}  // namespace baton
