/// Plain CDR and the generated types, whichever fastddsgen wrote them: 2.3, which goes with Fast CDR 1, or 4.0, which
/// goes with Fast CDR 2. A message is written by `cdr << message` and read by `cdr >> message` with both.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/config.h>
#include <fastcdr/exceptions/Exception.h>

#include <cstddef>

namespace baton::msg {

using eprosima::fastcdr::FastBuffer;
using CdrError = eprosima::fastcdr::exception::Exception;

#if FASTCDR_VERSION_MAJOR >= 2

/// A stream of plain CDR, the first version of it, with a header of 4 bytes in front.
class PlainCdr : public eprosima::fastcdr::Cdr {
 public:
  explicit PlainCdr(FastBuffer& buffer, Endianness byte_order = DEFAULT_ENDIAN)
      : Cdr(buffer, byte_order, eprosima::fastcdr::CdrVersion::XCDRv1) {
    set_encoding_flag(eprosima::fastcdr::EncodingAlgorithmFlag::PLAIN_CDR);
  }
  [[nodiscard]] std::size_t length() const { return get_serialized_data_length(); }
};

/// fastddsgen 4 has a constant for each type, by the type's name alone; compile.sh writes the table.
template <class T>
inline constexpr std::size_t max_cdr_size = 0;

/// The most bytes a message of type T can take, without the header.
template <class T>
[[nodiscard]] constexpr std::size_t maxCdrSize() {
  static_assert(max_cdr_size<T> > 0, "no type of idl/");
  return max_cdr_size<T>;
}

/// Reads a message member by member. Stands for Cdr::deserialize_type() in generated code (compile.sh), which accepts
/// a payload that ends after any member: the other members would keep what the message held before.
template <class ReadMember>
void readEveryMember(eprosima::fastcdr::Cdr& cdr, eprosima::fastcdr::EncodingAlgorithmFlag, ReadMember read_member) {
  eprosima::fastcdr::MemberId member(0);
  while (read_member(cdr, member)) ++member.id;
}

#else

class PlainCdr : public eprosima::fastcdr::Cdr {
 public:
  explicit PlainCdr(FastBuffer& buffer, Endianness byte_order = DEFAULT_ENDIAN) : Cdr(buffer, byte_order, DDS_CDR) {}
  [[nodiscard]] std::size_t length() const { return getSerializedDataLength(); }
};

template <class T>
[[nodiscard]] std::size_t maxCdrSize() {
  return T::getMaxCdrSerializedSize();
}

#endif

}  // namespace baton::msg
