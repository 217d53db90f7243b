"""The pages that go back to the students, with nothing harmful in them."""
