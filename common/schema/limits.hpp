/// How much a text may ask for. A recording can come from anywhere: these bound the memory and the time that reading
/// one takes, far above what real types need.
#pragma once

#include <cstddef>
#include <cstdint>

namespace baton::schema {

inline constexpr std::size_t kMaxTextBytes = std::size_t{1} << 20;
inline constexpr std::size_t kMaxNameBytes = 512;                        // with its modules
inline constexpr std::size_t kMaxDefinitions = 20'000;                   // types of a text, and names
inline constexpr std::size_t kMaxProblems = 1'000;                       // definitions that cannot be read
inline constexpr std::size_t kMaxMembers = 1'000;                        // of a struct or union, and labels
inline constexpr std::size_t kMaxInheritedBytes = std::size_t{1} << 24;  // that members inherited by all structs take
inline constexpr std::size_t kMaxEnumerators = 5'000;                    // of an enum
inline constexpr unsigned kMaxDepth = 32;                                // of modules in modules and of types in types
inline constexpr std::uint64_t kMaxLeastBytes = 1U << 28;                // what a message of a type takes at least
inline constexpr std::uint32_t kMaxEmpty = 1'000;  // structs without members in a message: they take no bytes

}  // namespace baton::schema
