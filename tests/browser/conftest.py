"""What a failed test of the browser leaves behind: the text of the page at that moment."""

import pytest


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    """Add the text of the page to the report of a failed test."""
    report = yield
    page = item.funcargs.get("page") if hasattr(item, "funcargs") else None
    if report.when == "call" and report.failed and page is not None and not page.is_closed():
        report.sections.append(("page", page.locator("body").inner_text()))
    return report
