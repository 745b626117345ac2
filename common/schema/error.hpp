/// What can be wrong with a type's text or with a payload.
#pragma once

#include "base/error.hpp"

namespace baton::schema {

/// The text is not IDL as idl_parser.hpp describes it. The message names the line, what was expected and what was
/// found.
class IdlError : public UsageError {
 public:
  using UsageError::UsageError;
};

/// The bytes are not a message of the type. The message names the member, what was expected and what was found.
class PayloadError : public UsageError {
 public:
  using UsageError::UsageError;
};

}  // namespace baton::schema
