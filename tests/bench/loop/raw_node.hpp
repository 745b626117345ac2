/// The yardstick's share of Fast DDS: a participant, and readers and writers of generated types, straight from the
/// product's API. Transports, discovery and QoS have the values that idl/README.md gives Baton's loop topics; nothing
/// of Baton is used but the generated types and the names that Fast DDS 2 and 3 have in common.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "dds/fastdds.hpp"

namespace raw {
namespace dds = baton::fastdds::dds;

struct Network {
  int domain = 0;
  std::string partition;
  bool shared_memory = false;  // in addition to UDP on loopback; Fast DDS then prefers it
};

/// What a process has on DDS. Listeners run on DDS's receive threads until it is destroyed.
class Node {
 public:
  /// Throws std::runtime_error when DDS refuses.
  explicit Node(const Network& network);
  ~Node();
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  /// A writer of a generated type (PlantStatePubSubType, ...) that will be read by so many.
  template <class Type>
  dds::DataWriter* writer(const std::string& topic, int readers) {
    dds::DataWriter* created = createWriter(dds::TypeSupport(new Type), topic);
    writers_.emplace_back(created, readers);
    return created;
  }

  /// A reader of a topic with one writer. `on_sample(message)` is called in DDS's receive thread.
  template <class Type>
  void reader(const std::string& topic, std::function<void(const typename Type::type&)> on_sample) {
    listeners_.push_back(std::make_unique<Listener<typename Type::type>>(std::move(on_sample)));
    readers_.push_back(createReader(dds::TypeSupport(new Type), topic, listeners_.back().get()));
  }

  /// Waits until every reader and writer is matched with everybody on the other side.
  void awaitMatches() const;

 private:
  template <class Message>
  class Listener final : public dds::DataReaderListener {
   public:
    explicit Listener(std::function<void(const Message&)> on_sample) : on_sample_(std::move(on_sample)) {}
    void on_data_available(dds::DataReader* reader) override {
      dds::SampleInfo info;
      while (baton::fastdds::isDone(reader->take_next_sample(&message_, &info))) {
        if (info.valid_data) on_sample_(message_);
      }
    }

   private:
    std::function<void(const Message&)> on_sample_;
    Message message_;
  };

  dds::Topic* createTopic(const dds::TypeSupport& type, const std::string& name);
  dds::DataWriter* createWriter(const dds::TypeSupport& type, const std::string& topic);
  dds::DataReader* createReader(const dds::TypeSupport& type, const std::string& topic,
                                dds::DataReaderListener* listener);

  dds::DomainParticipant* participant_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
  std::vector<std::unique_ptr<dds::DataReaderListener>> listeners_;
  std::vector<dds::DataReader*> readers_;
  std::vector<std::pair<dds::DataWriter*, int>> writers_;  // and by how many it is read
};

}  // namespace raw
