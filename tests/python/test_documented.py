"""Every name that `import tides` offers has a docstring: modules, classes, functions, methods and properties."""
import inspect

import tides


def offered():
    """(name, object) of what is public, and of what public classes of the package have of their own."""
    for name in tides.__all__:
        value = getattr(tides, name)
        if inspect.ismodule(value) or inspect.isclass(value) or inspect.isfunction(value):
            yield name, value
        if inspect.isclass(value) and value.__module__.startswith("tides"):
            for member, what in vars(value).items():
                if not member.startswith("_") and (inspect.isfunction(what) or isinstance(what, (property, classmethod, staticmethod))):
                    yield f"{name}.{member}", what


def test_everything_offered_is_documented():
    names = dict(offered())
    assert len(names) > 100
    assert [name for name, what in names.items() if not inspect.getdoc(getattr(what, "__func__", what))] == []
