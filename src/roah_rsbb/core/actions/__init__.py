"""What a person may do in a zone: one object for each action of `model.actions`, in files by subject.

`table.Actions` has all of them: it checks, records and carries out every call. Nothing else decides.
"""
