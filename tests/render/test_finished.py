from cutis.render.finished import Finished, digest


def test_a_picture_is_done_when_it_is_there_by_the_same_recipe(tmp_path):
    log, picture = tmp_path / "a.frames.json", tmp_path / "a.0001.png"
    one, other = digest({"seed": 1}), digest({"seed": 2})
    assert not Finished(log).has(picture, one)
    picture.write_bytes(b"x")
    Finished(log).put(picture, one)
    assert Finished(log).has(picture, one)
    assert not Finished(log).has(picture, other)
    picture.unlink()
    assert not Finished(log).has(picture, one)


def test_a_picture_about_to_be_written_anew_is_forgotten(tmp_path):
    log, picture = tmp_path / "a.frames.json", tmp_path / "a.0001.png"
    picture.write_bytes(b"x")
    recipe = digest({"seed": 1})
    Finished(log).put(picture, recipe)
    Finished(log).drop(picture)
    assert not Finished(log).has(picture, recipe)
    Finished(log).drop(picture)  # a second time is as good


def test_the_order_of_a_recipe_does_not_matter():
    assert digest({"a": 1, "b": [1.5]}) == digest({"b": [1.5], "a": 1})
    assert digest({"a": 1}) != digest({"a": 2})


def test_a_broken_list_is_an_empty_one(tmp_path):
    log, picture = tmp_path / "a.frames.json", tmp_path / "a.0001.png"
    picture.write_bytes(b"x")
    for text in ("", "[]", "{"):
        log.write_text(text)
        assert not Finished(log).has(picture, digest({}))
