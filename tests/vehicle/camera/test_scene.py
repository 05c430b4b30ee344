"""What the simulated camera draws, and the time in its top rows."""

from __future__ import annotations

import math
import random

from link.services.video_stamp import FIELDS, ROWS, build_stamp, draw_stamp, read_stamp
from vehicle.camera.capture import build_capture, build_encoder, picture_size, stamp_picture
from vehicle.camera.scene import FAR, Pose, Scene
from vehicle.camera.settings import SIMULATED_CAMERA, CameraSettings, find_problems

WIDTH, HEIGHT = 96, 64
BRICK = (176, 92, 62)


def colour(planes: bytes, x: int, y: int) -> tuple[int, int, int]:
    """Red, green and blue of a pixel."""
    size, at = WIDTH * HEIGHT, y * WIDTH + x
    return planes[2 * size + at], planes[at], planes[size + at]


def is_brick(planes: bytes, x: int, y: int) -> bool:
    red, green, blue = colour(planes, x, y)
    return red > green + 10 and green > blue - 15 and red > blue + 20 and red < 185


def test_a_wall_is_where_it_stands() -> None:
    scene = Scene(WIDTH, HEIGHT, [((2.0, -5.0), (2.0, 5.0))], home=None)
    middle, row = WIDTH // 2, 24
    assert is_brick(scene.draw(Pose()), middle, row)
    assert not is_brick(scene.draw(Pose(yaw=math.pi)), middle, row)
    assert not is_brick(scene.draw(Pose(north=3.0)), middle, row)
    near, far = (sum(is_brick(scene.draw(Pose(north=north)), middle, y) for y in range(HEIGHT)) for north in (1, -4))
    assert near > far > 0


def test_home_and_waypoints_are_posts_to_their_side() -> None:
    scene = Scene(WIDTH, HEIGHT, home=(4.0, -1.0))
    empty, seen = Scene(WIDTH, HEIGHT, home=None).draw(Pose()), scene.draw(Pose(), [(4.0, 1.0)])
    changed = {at % WIDTH for at in range(WIDTH * HEIGHT) if seen[at] != empty[at]}
    assert {x < WIDTH // 2 for x in changed} == {True, False}
    assert seen != scene.draw(Pose())


def test_any_pose_and_wall_is_a_whole_picture() -> None:
    chance = random.Random(4)
    for _ in range(150):
        numbers = [chance.choice((0.0, 0.001, -1.0, chance.uniform(-FAR, FAR), 1e6)) for _ in range(7)]
        scene = Scene(WIDTH, HEIGHT, [((numbers[0], numbers[1]), (numbers[2], numbers[3]))])
        assert len(scene.draw(Pose(numbers[4], numbers[5], numbers[6]))) == 3 * WIDTH * HEIGHT


def test_a_stamp_is_read_and_damage_is_noticed() -> None:
    for seconds in (0.0, 12345.678, 2**32 / 1000 + 5):
        row = draw_stamp(seconds, 320)
        fields = [row[(2 * index + 1) * 320 // (2 * FIELDS)] for index in range(FIELDS)]
        assert read_stamp(fields) == int(seconds * 1000) % 2**32 / 1000
        for index in range(FIELDS):
            assert read_stamp([255 - value if at == index else value for at, value in enumerate(fields)]) is None
    assert read_stamp([0] * FIELDS) is read_stamp([255] * FIELDS) is read_stamp([]) is None
    assert len(build_stamp(1.0)) == FIELDS


def test_the_stamp_is_on_top_of_each_kind_of_picture() -> None:
    for settings in (SIMULATED_CAMERA, CameraSettings(kind="rpicam", width=320, height=180)):
        size = picture_size(settings)
        stamped = stamp_picture(settings, b"\x55" * size, 7.0)
        assert stamped[: 320 * ROWS] == draw_stamp(7.0, 320) * ROWS
        assert stamped.count(b"\x55") == size
        assert len(stamped) == size * (180 + ROWS) // 180


def test_each_kind_has_its_programs() -> None:
    assert build_capture(SIMULATED_CAMERA) is None
    assert (build_capture(CameraSettings(kind="rpicam")) or [])[:1] == ["rpicam-vid"]
    assert "/dev/video2" in (build_capture(CameraSettings(kind="v4l2", device="/dev/video2")) or [])
    own = CameraSettings(kind="command", command=("my-camera", "--h264"))
    assert build_capture(own) == ["my-camera", "--h264"]
    assert "copy" in build_encoder(own, 1)
    words = build_encoder(SIMULATED_CAMERA, 1)
    assert "320x188" in words
    assert words[words.index("-g") + 1] == "8", "a key picture each half second"
    assert not find_problems(own)
    assert find_problems(CameraSettings(kind="command"))
    assert find_problems(SIMULATED_CAMERA)
