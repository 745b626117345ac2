#include "support/checkout.hpp"

namespace baton::test {

std::filesystem::path checkoutFolder() { return BATON_TEST_CHECKOUT; }
std::filesystem::path deployFolder() { return checkoutFolder() / "deploy"; }

}  // namespace baton::test
