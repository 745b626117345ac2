// Fuzz target: an IDL text, a zero, a payload. The text is parsed, and the payload read as each of its types.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>

#include "schema/error.hpp"
#include "schema/idl_parser.hpp"
#include "schema/limits.hpp"
#include "schema/message_reader.hpp"

namespace {

using namespace baton;

void require(bool holds) {
  if (!holds) std::abort();
}

/// Reads to the end or to what is no message; returns the items.
std::size_t read(const schema::Type& type, schema::Bytes payload) {
  std::size_t items = 0;
  std::size_t depth = 0;
  try {
    schema::MessageReader reader(type, payload);
    for (schema::Item item; reader.next(item); ++items) {
      if (item.what == schema::Item::What::kBegin) ++depth;
      if (item.what == schema::Item::What::kEnd) --depth;
      require(depth <= schema::kMaxDepth);
      require(item.type != nullptr);
      // Views stay within the payload.
      if (const auto* text = std::get_if<std::string_view>(&item.value); text != nullptr && !text->empty()) {
        const auto* begin = reinterpret_cast<const std::byte*>(text->data());
        require(begin >= payload.data() && begin + text->size() <= payload.data() + payload.size());
      }
      if (items % 1024 == 0) (void)reader.path();
    }
    require(depth == 0);
    (void)reader.path();
  } catch (const schema::PayloadError&) {
  }
  return items;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const std::size_t text_end = std::min(input.find('\0'), input.size());
  const schema::Bytes payload = std::as_bytes(std::span(data, size)).subspan(std::min(text_end + 1, size));
  try {
    const schema::TypeSet types = schema::parseIdl(input.substr(0, text_end));
    for (const auto& [name, type] : types.names()) {
      require(types.find(name) == type);
      require(type->depth <= schema::kMaxDepth);
      // Every value takes a byte, but for so many, so that a message costs what its bytes cost: within each value begin
      // and end of all that is around it.
      require(read(*type, payload) <= (payload.size() + 1 + schema::kMaxEmpty) * (2 * schema::kMaxDepth + 1));
    }
  } catch (const schema::IdlError&) {
  }
  return 0;
}
