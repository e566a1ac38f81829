import pytest

from tests.docs.blocks import parse_blocks, parse_console, parse_examples

PAGE = """\
Some words.

```python
print(1)
```

```text
1
```

```python
x = 2
```

Words between, so the next block is no output.

```json
{}
```

```console
$ echo a \\
    b
a b
$ echo c
c
```
""".splitlines()


def test_an_output_block_belongs_to_the_block_right_above_it() -> None:
    first, second, console = parse_examples(PAGE)
    assert first.output is not None
    assert first.output.text == "1"
    assert second.output is None
    assert console.output is None


def test_a_console_block_holds_commands_and_their_outputs() -> None:
    commands = parse_console(parse_examples(PAGE)[2].code)
    assert [command.text for command in commands] == ["echo a \\\n    b", "echo c"]
    assert [command.expected for command in commands] == ["a b", "c"]


def test_a_fence_left_open_is_an_error() -> None:
    with pytest.raises(ValueError, match="line 1 is not closed"):
        parse_blocks(["```python", "x = 1"])
