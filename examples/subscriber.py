"""Prints what the box says. subscriber.py [URL]"""
import sys

import lcm
import rfmvo

PREFIX = "RFMVO_"  # lcm.prefix of the box


def tag(m):
    epc = m.epc.hex().upper()
    if m.status == rfmvo.tag_estimate_t.CONVERGED:
        return "TAG {} at {:.3f} {:.3f} {:.3f} m".format(epc, *m.pos)
    return f"TAG {epc} not certain (status {m.status}, {m.num_hypotheses} hypotheses)"


def scale(m):
    if m.observable:
        return f"SCALE {m.m_per_unit:.4f} m per unit, {100 * m.log_sigma:.1f} %"
    return "SCALE not observable yet"


def health(m):
    return (f"HEALTH {m.frames} frames, {m.reads} reads, {m.tags_located} of {m.tags} tags located, "
            f"{m.faults} faults")


OUTPUTS = {
    "TAG": (rfmvo.tag_estimate_t, tag),
    "SCALE": (rfmvo.scale_t, scale),
    "METRIC_POSE": (rfmvo.metric_pose_t, lambda m: "METRIC_POSE {:.3f} {:.3f} {:.3f} m".format(*m.pos)),
    "POSE": (rfmvo.pose_t, lambda m: "POSE {:.3f} {:.3f} {:.3f} m".format(*m.pos)),
    "TRAJECTORY": (rfmvo.trajectory_t, lambda m: f"TRAJECTORY of {m.num_poses} poses"),
    "MAP_REVISION": (rfmvo.map_revision_t, lambda m: f"MAP_REVISION {m.revision}: {m.reason}"),
    "VO_POSE": (rfmvo.camera_pose_t, lambda m: "VO_POSE {:.3f} {:.3f} {:.3f} units".format(*m.pos)),
    "HEALTH": (rfmvo.health_t, health),
}


def main():
    bus = lcm.LCM(sys.argv[1] if len(sys.argv) > 1 else "udpm://239.255.76.67:7667?ttl=0")
    for name, (message_type, text_of) in OUTPUTS.items():
        def show(_channel, data, message_type=message_type, text_of=text_of):
            print(text_of(message_type.decode(data)), flush=True)
        bus.subscribe(PREFIX + name, show)
    print("listening", flush=True)
    while True:
        bus.handle()


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
