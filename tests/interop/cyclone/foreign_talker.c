/* A program of another vendor's DDS (Eclipse Cyclone DDS) in its default configuration, as people have one: it has
 * never heard of Baton, sets no partition, and sends no hash of its keys.
 *
 *   foreign_talker DOMAIN COUNT
 *
 * Writes readings of two sensors that late joiners get the latest of, before anybody reads; once somebody reads all
 * three topics, COUNT beacons reliably and COUNT on best effort, and more readings, of which one sensor is disposed of.
 */
#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>

#include "foreign.h"

static dds_entity_t made(dds_entity_t entity, const char* what) {
  if (entity >= 0) return entity;
  fprintf(stderr, "foreign_talker: cannot create %s: %s\n", what, dds_strretcode(-entity));
  exit(1);
}

static void done(dds_return_t result, const char* what) {
  if (result == DDS_RETCODE_OK) return;
  fprintf(stderr, "foreign_talker: %s: %s\n", what, dds_strretcode(-result));
  exit(1);
}

static dds_entity_t writerOn(dds_entity_t participant, const char* topic, const dds_topic_descriptor_t* type,
                             dds_reliability_kind_t reliability, dds_durability_kind_t durability) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, reliability, DDS_SECS(10));
  dds_qset_durability(qos, durability);
  if (durability == DDS_DURABILITY_TRANSIENT_LOCAL) {
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
    dds_qset_durability_service(qos, 0, DDS_HISTORY_KEEP_LAST, 1, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED);
  } else {
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  }
  const dds_entity_t writer = made(
      dds_create_writer(participant, made(dds_create_topic(participant, type, topic, NULL, NULL), "topic"), qos, NULL),
      "writer");
  dds_delete_qos(qos);
  return writer;
}

static void waitForReader(dds_entity_t writer) {
  dds_publication_matched_status_t status;
  for (int waited_ms = 0; waited_ms < 60000; waited_ms += 10) {
    if (dds_get_publication_matched_status(writer, &status) == DDS_RETCODE_OK && status.current_count > 0) return;
    dds_sleepfor(DDS_MSECS(10));
  }
  fprintf(stderr, "foreign_talker: nobody reads\n");
  exit(1);
}

/* Each reading is received before the next one takes its place. */
static void say(dds_entity_t readings, int32_t sensor, double value) {
  const foreign_Reading reading = {sensor, value};
  done(dds_write(readings, &reading), "a reading");
  done(dds_wait_for_acks(readings, DDS_SECS(60)), "acknowledgements");
}

int main(int argc, char** argv) {
  if (argc != 3) {
    fprintf(stderr, "usage: foreign_talker DOMAIN COUNT\n");
    return 2;
  }
  const dds_entity_t participant =
      made(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  const dds_entity_t beacons =
      writerOn(participant, "talk_beacons", &foreign_Beacon_desc, DDS_RELIABILITY_RELIABLE, DDS_DURABILITY_VOLATILE);
  const dds_entity_t beats =
      writerOn(participant, "talk_status", &foreign_Beacon_desc, DDS_RELIABILITY_BEST_EFFORT, DDS_DURABILITY_VOLATILE);
  const dds_entity_t readings = writerOn(participant, "talk_readings", &foreign_Reading_desc, DDS_RELIABILITY_RELIABLE,
                                         DDS_DURABILITY_TRANSIENT_LOCAL);
  say(readings, 1, 0.5);
  for (int i = 0; i < 5; ++i) say(readings, 2, i);
  waitForReader(beacons);
  waitForReader(beats);
  waitForReader(readings);

  const int count = atoi(argv[2]);
  double values[] = {0.5, 1.5};
  for (int i = 0; i < count; ++i) {
    foreign_Beacon beacon = {0};
    beacon.count = (uint64_t)i;
    snprintf(beacon.text, sizeof beacon.text, "beacon %d", i);
    beacon.values._length = beacon.values._maximum = 2;
    beacon.values._buffer = values;
    done(dds_write(beacons, &beacon), "a beacon");
    done(dds_write(beats, &beacon), "a beat");
  }
  done(dds_wait_for_acks(beacons, DDS_SECS(60)), "acknowledgements");
  say(readings, 1, 1.5);
  const foreign_Reading gone = {2, 0.0};
  done(dds_dispose(readings, &gone), "a sensor that is gone");
  say(readings, 1, 2.5);
  dds_delete(participant);
  return 0;
}
