#include "dds/types.hpp"

#include <algorithm>

namespace baton::dds {

GuidPrefix prefixOf(const Guid& guid) {
  GuidPrefix prefix;
  std::copy_n(guid.bytes.begin(), prefix.size(), prefix.begin());
  return prefix;
}

std::string toString(const Guid& guid) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (std::size_t i = 0; i < guid.bytes.size(); ++i) {
    if (i == std::tuple_size_v<GuidPrefix>) text += '.';
    text += kDigits[guid.bytes[i] >> 4];
    text += kDigits[guid.bytes[i] & 0xF];
  }
  return text;
}

}  // namespace baton::dds
